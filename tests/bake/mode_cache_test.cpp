// A bake from the cache is the bake that would have been made.
#include "engine/bake/body_modes.h"

#include "engine/bake/bake.h"
#include "engine/modal/bank_file.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <thread>
#include <vector>

namespace ringdown::mode_cache_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

const modal::Material kSteel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}};

// Three unlike edges, so that no two frequencies are equal.
mesh::CheckedMesh bar(double scale = 1) {
  return test::checked(test::box_mesh({8, 2, 2}, scale * Eigen::Vector3d(0.2, 0.025, 0.011)));
}

bake::Baked baked(const fs::path& cache, const modal::Material& material = kSteel, double scale = 1,
                  bake::BakeOptions options = {}, const Progress& progress = {}) {
  options.cache = cache;
  return bake::bake(bar(scale), material, options, "bar", progress).value();
}

std::string bytes_of(const modal::Bank& bank) {
  const TemporaryFolder folder;
  EXPECT_TRUE(modal::write_bank(bank, folder.path() / "x.glb"));
  std::ifstream file(folder.path() / "x.glb", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> entries(const fs::path& folder, const std::string& kind) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with(kind + "-")) found.push_back(entry.path());
  }
  return found;
}

void expect_equal(const modal::Bank& a, const modal::Bank& b, double relative) {
  ASSERT_EQ(a.mode_count(), b.mode_count());
  ASSERT_EQ(a.point_count(), b.point_count());
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_NEAR(a.mass->mass_kg / b.mass->mass_kg, 1, relative);
  EXPECT_NEAR(a.mass->inertia_kg_m2.x / b.mass->inertia_kg_m2.x, 1, relative);
  EXPECT_NEAR(a.mass->center_of_mass_m.x / b.mass->center_of_mass_m.x, 1, relative);
  for (std::size_t m = 0; m < a.mode_count(); ++m) {
    EXPECT_NEAR(a.frequency_hz[m] / b.frequency_hz[m], 1, relative) << m;
    EXPECT_NEAR(a.decay_per_s[m] / b.decay_per_s[m], 1, relative) << m;
    float largest = 0, off = 0;
    for (std::size_t p = 0; p < a.point_count(); ++p) {
      for (int i = 0; i < 3; ++i) {
        largest = std::max(largest, std::abs(b.shape(m, p)[i]));
        off = std::max(off, std::abs(a.shape(m, p)[i] - b.shape(m, p)[i]));
      }
    }
    EXPECT_LT(off, relative * largest) << m;
  }
}

TEST(ModeCache, TheCacheGivesTheSameBankByteForByteAndSolvesNothing) {
  const TemporaryFolder folder;
  const bake::Baked first = baked(folder.path());
  EXPECT_FALSE(first.report.from_cache);
  std::set<std::string> stages;
  const bake::Baked again = baked(folder.path(), kSteel, 1, {}, [&](std::string_view stage, double) {
    stages.emplace(stage);
    return true;
  });
  EXPECT_TRUE(again.report.from_cache);
  EXPECT_FALSE(stages.contains("factors") || stages.contains("modes"));
  EXPECT_TRUE(bytes_of(first.bank) == bytes_of(again.bank));
  EXPECT_TRUE(bytes_of(first.bank) == bytes_of(baked("").bank)) << "with or without a cache";
  EXPECT_EQ(again.report.unknowns, first.report.unknowns);
  EXPECT_EQ(again.report.rigid, 6);
}

TEST(ModeCache, TheCacheSolvesAgainWhatNoSecondMethodHasVerified) {
  const TemporaryFolder folder;
  const bake::Baked first = baked(folder.path());
  EXPECT_EQ(first.report.agreement.modes, 0);
  const bake::Baked verified = baked(folder.path(), kSteel, 1, {.verify = true});
  EXPECT_FALSE(verified.report.from_cache);
  EXPECT_GT(verified.report.agreement.modes, 0);
  EXPECT_TRUE(baked(folder.path(), kSteel, 1, {.verify = true}).report.from_cache);
  EXPECT_TRUE(baked(folder.path()).report.from_cache);
  expect_equal(first.bank, verified.bank, 1e-6);
}

// E, density, damping and size: each alone and all together, against a bake that has never seen the cache.
TEST(ModeCache, TheCacheRescalesToOtherMaterialsAndSizes) {
  struct Change {
    const char* what;
    std::function<void(modal::Material&, double& scale)> make;
  };
  const Change changes[] = {
      {"E", [](modal::Material& m, double&) { m.youngs_modulus_pa *= 1.37; }},
      {"density", [](modal::Material& m, double&) { m.density_kg_m3 *= 0.41; }},
      {"damping",
       [](modal::Material& m, double&) {
         m.damping = {40, 1e-7};
       }},
      {"size", [](modal::Material&, double& scale) { scale = 0.61; }},
      {"all",
       [](modal::Material& m, double& scale) {
         m = {"odd", 61e9, 0.3, 1930, {0.3, 2e-7}}, scale = 0.83;
       }},
      {"order",
       [](modal::Material& m, double&) {
         m.damping = {0, 6e-6};
       }},
  };
  const TemporaryFolder folder;
  const bake::Baked first = baked(folder.path(), kSteel, 1, {.band_high_hz = 24000});
  for (const Change& change : changes) {
    modal::Material material = kSteel;
    double scale = 1;
    change.make(material, scale);
    const bake::Baked kept = baked(folder.path(), material, scale), fresh = baked("", material, scale);
    EXPECT_TRUE(kept.report.from_cache) << change.what;
    SCOPED_TRACE(change.what);
    expect_equal(kept.bank, fresh.bank, 1e-6);
    EXPECT_EQ(kept.report.over_damped, fresh.report.over_damped);
  }
  // Heavy damping of high modes brings low ones to the front: the order is this bake's own.
  modal::Material dull = kSteel;
  dull.damping = {0, 6e-6};
  const auto front = [](const bake::Baked& bake) { return bake.bank.frequency_hz.front(); };
  EXPECT_LT(front(baked(folder.path(), dull)), front(first));
}

TEST(ModeCache, TheCacheCoversNarrowerBandsAndGrowsWithWiderOnes) {
  const TemporaryFolder folder;
  EXPECT_FALSE(baked(folder.path(), kSteel, 1, {.band_high_hz = 10000}).report.from_cache);
  const bake::Baked narrow = baked(folder.path(), kSteel, 1, {.band_high_hz = 6000});
  EXPECT_TRUE(narrow.report.from_cache);
  expect_equal(narrow.bank, baked("", kSteel, 1, {.band_high_hz = 6000}).bank, 1e-6);
  EXPECT_FALSE(baked(folder.path(), kSteel, 1, {.band_high_hz = 12000}).report.from_cache);
  EXPECT_TRUE(baked(folder.path(), kSteel, 1, {.band_high_hz = 12000}).report.from_cache);
  EXPECT_TRUE(baked(folder.path(), kSteel, 1, {.band_high_hz = 10000, .points = 10}).report.from_cache);
  EXPECT_EQ(entries(folder.path(), "modes").size(), 1u);
}

TEST(ModeCache, TooManyModesAreRefusedAllTheSame) {
  const TemporaryFolder folder;
  (void)baked(folder.path());
  const auto refused = bake::bake(bar(), kSteel, {.max_modes = 3, .cache = folder.path()}, "bar");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("more than 3 modes"), std::string::npos);
}

TEST(ModeCache, TheCacheKnowsWhatDoesNotRescale) {
  const TemporaryFolder folder;
  (void)baked(folder.path());
  modal::Material material = kSteel;
  material.poisson_ratio = 0.3000001;
  EXPECT_FALSE(baked(folder.path(), material).report.from_cache);
  EXPECT_FALSE(baked(folder.path(), kSteel, 1, {.element = fem::Element::kTet4}).report.from_cache);
  EXPECT_FALSE(baked(folder.path(), kSteel, 1, {.element = fem::Element::kTet4Lumped}).report.from_cache);
  EXPECT_TRUE(baked(folder.path()).report.from_cache);
  for (const double step : {1e-3, 1e-6, 1e-9, 1e-12}) {  // below 1e-8 of the length the key is the same
    mesh::CheckedMesh other = bar();
    other.mesh.nodes(7, 1) += step;
    EXPECT_FALSE(bake::bake(other, kSteel, {.cache = folder.path()}, "bar")->report.from_cache) << step;
  }
}

TEST(ModeCache, TheCacheTrustsNoDamagedEntryAndReplacesIt) {
  const TemporaryFolder folder;
  const modal::Bank good = baked(folder.path()).bank;
  const fs::path entry = entries(folder.path(), "modes").at(0);
  const auto size = fs::file_size(entry);
  const std::pair<const char*, std::function<void()>> damages[] = {
      {"a bit",
       [&] { std::fstream(entry, std::ios::in | std::ios::out).seekp(static_cast<long>(size / 2)).put('\x55'); }},
      {"cut", [&] { fs::resize_file(entry, size / 3); }},
      {"foreign", [&] { std::ofstream(entry) << "not ours"; }},
      {"empty", [&] { fs::resize_file(entry, 0); }},
  };
  for (const auto& [what, damage] : damages) {
    damage();
    const bake::Baked again = baked(folder.path());
    EXPECT_FALSE(again.report.from_cache) << what;
    // Not to the last bit: what the cache still knows of the body's pitches moves the solver's shifts.
    ASSERT_EQ(again.bank.mode_count(), good.mode_count()) << what;
    for (std::size_t m = 0; m < good.mode_count(); ++m) {
      EXPECT_NEAR(again.bank.frequency_hz[m] / good.frequency_hz[m], 1, 1e-9) << what;
    }
    EXPECT_TRUE(baked(folder.path()).report.from_cache) << what;
  }
}

// Whole entries whose content makes no sense: a checksum proves only that nothing changed since.
TEST(ModeCache, TheCacheTrustsNoEntryThatContradictsTheMesh) {
  const TemporaryFolder folder;
  const bake::ModeCache cache{ContentCache(folder.path())};
  const mesh::TetMesh mesh = test::box_mesh({1, 1, 1}, {1, 1, 1});
  const bake::BodyQuestion question{mesh, 8, fem::Element::kTet4, 0.3, 1e-9};
  bake::BodyModes good;
  good.lambda = Eigen::VectorXd::LinSpaced(3, 1, 3);
  good.shapes = Eigen::MatrixXd::Ones(24, 3);
  good.residuals = Eigen::VectorXd::Zero(3);
  good.complete_to = 10;
  ASSERT_TRUE(cache.store(question, good));
  EXPECT_TRUE(cache.find(question, 10, 3));
  EXPECT_EQ(cache.find(question, 2.5, 3)->lambda.size(), 2);
  EXPECT_FALSE(cache.find(question, 10.1, 3)) << "beyond what is known";
  EXPECT_FALSE(cache.find(question, 10, 2));
  const std::function<void(bake::BodyModes&)> changes[] = {
      [](auto& m) { m.shapes.conservativeResize(21, 3); },
      [](auto& m) { m.lambda[1] = -1; },
      [](auto& m) { m.lambda[1] = NAN; },
      [](auto& m) { m.shapes(5, 2) = INFINITY; },
      [](auto& m) { m.residuals.conservativeResize(2); },
      [](auto& m) { m.errors = Eigen::VectorXd::Zero(2); },
      [](auto& m) { m.lambda.reverseInPlace(); },
      [](auto& m) { m.complete_to = NAN; },
  };
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    bake::BodyModes bad = good;
    changes[i](bad);
    ASSERT_TRUE(cache.store(question, bad));
    EXPECT_FALSE(cache.find(question, 10, 3)) << i;
  }
}

TEST(ModeCache, ABakeSucceedsWhereTheCacheCannot) {
  const TemporaryFolder folder;
  const bake::Baked kept = baked(folder.write("file", "") / "below");
  EXPECT_NE(kept.report.cache_trouble.find("cannot write"), std::string::npos);
  EXPECT_TRUE(bytes_of(kept.bank) == bytes_of(baked("").bank));
}

TEST(ModeCache, TheCacheIsSharedByBakesAtTheSameTime) {
  const TemporaryFolder folder;
  std::vector<modal::Bank> banks(3);
  {
    std::vector<std::jthread> threads;
    for (modal::Bank& bank : banks) threads.emplace_back([&] { bank = baked(folder.path()).bank; });
  }
  for (const modal::Bank& bank : banks) expect_equal(bank, banks[0], 1e-6);
  EXPECT_TRUE(baked(folder.path()).report.from_cache);
}

// What the solver may plan with when only Poisson's ratio or the mesh has changed.
TEST(ModeCache, TheCacheRemembersWhereARelativesModesWere) {
  const TemporaryFolder folder;
  const bake::ModeCache cache{ContentCache(folder.path())};
  modal::Material material = kSteel;
  const bake::Baked first = baked(folder.path(), material);
  mesh::TetMesh unit_mesh = mesh::to_order(bar().mesh, 3);
  const double length = bake::characteristic_length(unit_mesh.nodes);
  unit_mesh.nodes /= length;
  const bake::BodyQuestion question{unit_mesh, 0, fem::Element::kTet20, 0.25, 1e-9};
  const Eigen::VectorXd expected = cache.expected(question, "");
  ASSERT_EQ(expected.size(), static_cast<Eigen::Index>(first.bank.mode_count()));
  material.poisson_ratio = 0.25;
  std::vector<double> found = baked("", material).bank.frequency_hz;
  std::sort(found.begin(), found.end());
  const bake::BodyUnits units{length, material.youngs_modulus_pa, material.density_kg_m3};
  for (std::size_t m = 0; m < std::min<std::size_t>(found.size(), 20); ++m) {
    const double hz = std::sqrt(units.lambda() * expected[static_cast<Eigen::Index>(m)]) / (2 * M_PI);
    EXPECT_NEAR(hz / found[m], 1, 0.03) << m;
  }
  EXPECT_EQ(cache.expected(question, "another family").size(), 0);
  ASSERT_TRUE(cache.expect(question, "another family", Eigen::VectorXd::LinSpaced(4, 1, 4)));
  const mesh::TetMesh finer = test::box_mesh({2, 2, 2}, {1, 1, 1});
  EXPECT_EQ(cache.expected({finer, 0, fem::Element::kTet4, 0.4, 1e-9}, "another family").size(), 4);
}

}  // namespace
}  // namespace ringdown::mode_cache_test
