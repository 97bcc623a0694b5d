// What a baked bank says of its modes' radiation, in each size and material, fresh or from the cache.
#include "engine/bake/bake.h"
#include "engine/base/atomic_file.h"
#include "engine/base/content_hash.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/material_scale.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::radiation_test {
namespace {

using test::TemporaryFolder;

const modal::Material kSteel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}};
constexpr modal::Air kAir{.density_kg_m3 = 1.2, .sound_speed_m_s = 343};

// Three unlike edges, thick enough that few panels do.
bake::Baked baked(const modal::Material& material, double size, double top_hz, const std::filesystem::path& cache,
                  const std::optional<modal::Air>& air = kAir, const Progress& progress = {}) {
  const mesh::TetMesh mesh = test::box_mesh({6, 2, 2}, size * Eigen::Vector3d(0.12, 0.05, 0.04));
  bake::BakeOptions options{.band_low_hz = 20, .band_high_hz = top_hz, .air = air, .cache = cache};
  return bake::bake(test::checked(mesh), material, options, "box", progress).value();
}

class BakedRadiation : public testing::Test {
 protected:
  static void SetUpTestSuite() { cache_ = new TemporaryFolder; }
  static void TearDownTestSuite() { delete cache_; }
  static std::filesystem::path cache() { return cache_->path(); }

 private:
  static inline TemporaryFolder* cache_ = nullptr;
};

TEST_F(BakedRadiation, TheAirTakesWhatTheMapsRadiateAndEachDecayIsTheSumOfItsParts) {
  const bake::Baked with = baked(kSteel, 1, 16000, cache()), without = baked(kSteel, 1, 16000, cache(), std::nullopt);
  const modal::Bank& bank = with.bank;
  ASSERT_TRUE(bank.radiation);
  EXPECT_FALSE(without.bank.radiation);
  ASSERT_EQ(bank.radiation->maps.modes.size(), bank.mode_count());
  ASSERT_EQ(bank.mode_count(), without.bank.mode_count());
  EXPECT_EQ(bank.radiation->air.density_kg_m3, kAir.density_kg_m3);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const modal::FarField& field = bank.radiation->maps.modes[m];
    const double omega = std::sqrt(modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}));
    EXPECT_NEAR(field.wavenumber_rad_m * kAir.sound_speed_m_s / omega, 1, 1e-6);
    double mean_square = 0;  // of F over directions
    for (const auto& term : field.terms) mean_square += std::norm(std::complex<double>(term.value)) / (4 * M_PI);
    const double power_w = 2 * M_PI * kAir.density_kg_m3 * omega * omega * mean_square / kAir.sound_speed_m_s;
    EXPECT_NEAR(bank.losses[m].air_per_s / power_w, 1, 1e-5);
    EXPECT_NEAR(bank.losses[m].material_per_s, 0.5 * 3e-8 * omega * omega, 1e-6);
    EXPECT_NEAR(bank.decay_per_s[m], bank.losses[m].material_per_s + std::max(2.5, bank.losses[m].air_per_s), 1e-9);
    EXPECT_EQ(without.bank.losses[m].air_per_s, 0);
  }
}

TEST_F(BakedRadiation, ABankFromTheCacheIsTheSameFile) {
  const bake::Baked first = baked(kSteel, 1, 16000, cache()), second = baked(kSteel, 1, 16000, cache());
  EXPECT_TRUE(second.report.radiation.from_cache);
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(first.bank, folder / "a.glb"));
  ASSERT_TRUE(modal::write_bank(second.bank, folder / "b.glb"));
  EXPECT_EQ(hash_of(read_whole_file(folder / "a.glb", 1 << 24).value()),
            hash_of(read_whole_file(folder / "b.glb", 1 << 24).value()));
}

TEST_F(BakedRadiation, AnotherSizeComesFromTheCacheAndIsTheBankRescaled) {
  const modal::Bank one = baked(kSteel, 1, 16000, cache()).bank;
  const bake::Baked two = baked(kSteel, 2, 8000, cache());
  EXPECT_TRUE(two.report.radiation.from_cache);
  ASSERT_EQ(two.bank.mode_count(), one.mode_count());
  for (std::size_t m = 0; m < one.mode_count(); ++m) {
    const auto found = std::ranges::min_element(
        one.frequency_hz, {}, [&](double f) { return std::abs(f / 2 / two.bank.frequency_hz[m] - 1); });
    const auto n = static_cast<std::size_t>(found - one.frequency_hz.begin());
    const modal::FarField expected = modal::rescale(one.radiation->maps.modes[n], {.size = 2});
    EXPECT_NEAR(modal::rms(two.bank.radiation->maps.modes[m]) / modal::rms(expected), 1, 1e-6);
    EXPECT_NEAR(two.bank.radiation->maps.modes[m].wavenumber_rad_m / expected.wavenumber_rad_m, 1, 1e-6);
    EXPECT_NEAR(two.bank.losses[m].air_per_s / (one.losses[n].air_per_s / 2), 1, 1e-5);
  }
}

TEST_F(BakedRadiation, RadiationCanBeCancelled) {
  const mesh::TetMesh mesh = test::box_mesh({6, 2, 2}, {0.12, 0.05, 0.04});
  const bake::BakeOptions options{.band_high_hz = 16000, .air = kAir};
  const auto cancelled = bake::bake(test::checked(mesh), kSteel, options, "box",
                                    [](std::string_view stage, double) { return stage != "radiation"; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, ErrorKind::cancelled);
}

TEST_F(BakedRadiation, ABakeThatWillBeRefinedDoesNotRadiate) {
  const mesh::TetMesh mesh = test::box_mesh({6, 2, 2}, {0.12, 0.05, 0.04});
  const bake::BakeOptions options{.band_high_hz = 16000, .air = kAir, .radiation_error = 1e-9};
  EXPECT_FALSE(bake::bake(test::checked(mesh), kSteel, options, "box").value().bank.radiation);
}

}  // namespace
}  // namespace ringdown::radiation_test
