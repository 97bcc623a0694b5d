// Tubes under bars, in object files and in bakes.
#include "engine/bake/bake_object.h"
#include "engine/bake/object_file.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/tubes/tube_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::resonator_test {
namespace {

namespace fs = std::filesystem;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";
constexpr double kArch_m = 0.00747506;  // height of the bar's underside in its middle
constexpr double kBareDecay_per_s = 0.515;

Result<bake::ObjectRecipe> parsed(const std::string& tables) {
  return bake::parse_object("material = \"aluminium\"\ngeometry = \"bar.msh\"\n" + tables, "bar.toml");
}

std::string refusal(const std::string& tables) {
  const auto recipe = parsed(tables);
  return recipe ? "accepted" : recipe.error().message;
}

TEST(ResonatorRecipe, AnObjectFileSaysWhereTheTubeIsAndWhatItIsTunedTo) {
  const std::string tube = "[[resonator]]\ndiameter_m = 0.04\nmouth_m = [0, 0, -0.01]\n";
  const auto plain = parsed(tube).value().options;
  ASSERT_EQ(plain.resonators.size(), 1u);
  EXPECT_DOUBLE_EQ(plain.resonators[0].radius_m, 0.02);
  EXPECT_EQ(plain.resonators[0].tuned_mode, 1);
  EXPECT_TRUE(plain.resonators[0].stopped);
  EXPECT_TRUE(plain.air) << "a tube implies radiation";
  const auto note = parsed(tube + "tuned_to = \"A4\"\ndetune_cents = -10\nstopped = false\naxis = [0, 1, 0]\n");
  EXPECT_DOUBLE_EQ(note.value().options.resonators[0].tuned_hz.value(), 440);
  EXPECT_FALSE(note.value().options.resonators[0].stopped);
  EXPECT_DOUBLE_EQ(parsed(tube + "tuned_to = 225.5\n").value().options.resonators[0].tuned_hz.value(), 225.5);
  EXPECT_EQ(parsed(tube + "tuned_to = 2\n").value().options.resonators[0].tuned_mode, 2);
  EXPECT_DOUBLE_EQ(parsed(tube + "length_m = 0.3\n").value().options.resonators[0].scaled(2).length_m.value(), 0.6);
}

TEST(ResonatorRecipe, AWrongValueIsRefusedWithASentence) {
  const std::string tube = "[[resonator]]\ndiameter_m = 0.04\nmouth_m = [0, 0, -0.01]\n";
  for (const std::string& tables :
       {std::string("[[resonator]]\nmouth_m = [0, 0, 0]\n"), std::string("[[resonator]]\ndiameter_m = 0.04\n"),
        std::string("[[resonator]]\ndiameter_m = 0\nmouth_m = [0, 0, 0]\n"), tube + "tuned_to = 1.5\n",
        tube + "tuned_to = 0\n", tube + "tuned_to = \"H4\"\n", tube + "tuned_to = 1\nlength_m = 0.3\n",
        tube + "detune_cents = 5\nlength_m = 0.3\n", tube + "axis = [0, 0, 0]\n", tube + "colour = 1\n"})
    EXPECT_EQ(refusal(tables).find("bar.toml:"), 0u) << tables << refusal(tables);
}

// The preset vibraphone-key with a loss of 0.515 1/s of every mode and a tube of 40 mm, baked once for each tube. The
// modes of the bar are solved once, in the cache.
class TubedBar {
 public:
  // The bar with the tables of an object file added to its own. Fails the test that asks where it should not have been
  // refused.
  const modal::Bank& bank(const std::string& tables) {
    const auto known = banks_.find(tables);
    if (known != banks_.end()) return known->second;
    auto object = baked(tables);
    EXPECT_TRUE(object) << object.error().message;
    return banks_[tables] = object ? std::move(object->baked.bank) : modal::Bank{};
  }

  std::string refusal(const std::string& tables) {
    const auto object = baked(tables);
    return object ? "accepted" : object.error().message;
  }

  fs::path folder() const { return folder_.path(); }

 private:
  Result<bake::BakedObject> baked(const std::string& tables) {
    auto recipe = bake::parse_object(
        "material = \"aluminium\"\ngeometry = \"bar.geo\"\nunit_m = 0.001\nmesh_size_m = 0.012\nradiation = true\n"
        "band_hz = [20, 1000]\nshape_error = 0.1\n[parameters]\nlength = 347.386\nwidth = 50\nthickness = 12.7\n"
        "arch_share = 0.482004\narch_depth = 7.47506\n" +
            tables,
        kPresets / "objects" / "bar.toml");
    if (!recipe) return fail(recipe.error());
    recipe->options.cache = folder_.path() / "cache";
    modal::Material material = bake::find_material(kPresets / "materials", "aluminium").value().material;
    material.loss_factors.clear();
    material.thermal.reset();
    material.damping = {.alpha_per_s = 2 * kBareDecay_per_s, .beta_s = 0};
    return bake::bake_recipe(*recipe, material);
  }

  test::TemporaryFolder folder_;
  std::map<std::string, modal::Bank> banks_;
};

std::string tube(double gap_m, const std::string& more = "") {
  char text[160];
  std::snprintf(text, sizeof text, "[[resonator]]\ndiameter_m = 0.04\nmouth_m = [0, 0, %.6f]\n", kArch_m - gap_m);
  return text + more;
}

// The modes within 30 Hz of the bar's lowest, by ascending decay.
std::vector<std::size_t> fundamentals(const modal::Bank& bank) {
  std::vector<std::size_t> modes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (std::abs(bank.frequency_hz[m] - 220) < 30) modes.push_back(m);
  }
  std::ranges::sort(modes, {}, [&](std::size_t m) { return bank.decay_per_s[m]; });
  return modes;
}

double rms_shape(const modal::Bank& bank, std::size_t mode) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const float x : bank.shape(mode, p)) sum += x * x;
  }
  return std::sqrt(sum / static_cast<double>(bank.point_count()));
}

// How much louder a mode radiates at the same motion of the bar [dB].
double gain_db(const modal::Bank& with, std::size_t mode, const modal::Bank& bare, std::size_t bare_mode) {
  const double motion = rms_shape(with, mode) / rms_shape(bare, bare_mode);
  return 20 * std::log10(modal::rms(with.radiation->maps.modes[mode]) / motion /
                         modal::rms(bare.radiation->maps.modes[bare_mode]));
}

// Decays and levels of a prototype that shares no code with the engine: static boundary elements of flat panels with
// constant strength, and the poles of the full equation found by secants. The bare bar falls by 60 dB in 13.4 s.
void expect_louder_and_shorter_as_the_gap_closes(TubedBar& bar) {
  const modal::Bank& alone = bar.bank("");
  ASSERT_EQ(fundamentals(alone).size(), 1u);
  const std::size_t own = fundamentals(alone)[0];
  EXPECT_NEAR(alone.decay_per_s[own], kBareDecay_per_s, 1e-6);
  struct Row {
    double gap_m, decay_per_s, gain_db;
  };
  for (const Row& row : {Row{0.025, 1.02, 25.1}, Row{0.015, 1.77, 29.5}, Row{0.008, 4.41, 36.7}}) {
    const modal::Bank& bank = bar.bank(tube(row.gap_m));
    const std::vector<std::size_t> modes = fundamentals(bank);
    ASSERT_EQ(modes.size(), 2u) << row.gap_m;
    std::printf("gap %.0f mm: %.3f Hz %.3f 1/s, %.3f Hz %.3f 1/s, %+.2f dB; tube %.4f m, %.3f Hz, %.2f 1/s, end %.4f\n",
                1e3 * row.gap_m, bank.frequency_hz[modes[0]], bank.decay_per_s[modes[0]], bank.frequency_hz[modes[1]],
                bank.decay_per_s[modes[1]], gain_db(bank, modes[0], alone, own), bank.provenance.resonators[0].length_m,
                bank.provenance.resonators[0].frequency_hz, bank.provenance.resonators[0].decay_per_s,
                bank.provenance.resonators[0].end_correction_m);
    EXPECT_NEAR(bank.decay_per_s[modes[0]] / row.decay_per_s, 1, 0.1) << row.gap_m;
    EXPECT_NEAR(gain_db(bank, modes[0], alone, own), row.gain_db, 1) << row.gap_m;
    // The tube is silent when the bar is struck: its two modes begin with opposite signs and like strengths.
    std::size_t loudest = 0;
    double most = 0;
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const double x = std::abs(bank.shape(modes[0], p)[2]);
      if (x > most) most = x, loudest = p;
    }
    const double first = bank.shape(modes[0], loudest)[2] * modal::rms(bank.radiation->maps.modes[modes[0]]);
    const double second = bank.shape(modes[1], loudest)[2] * modal::rms(bank.radiation->maps.modes[modes[1]]);
    EXPECT_LT(std::abs(first + second), 0.15 * std::abs(first)) << row.gap_m;
    // The parts of each decay add up to it.
    for (std::size_t m = 0; m < bank.mode_count(); ++m)
      EXPECT_NEAR(bank.losses[m].total_per_s() / bank.decay_per_s[m], 1, 1e-9);
  }
}

void expect_far_tube_changes_nothing(TubedBar& bar) {
  const modal::Bank &alone = bar.bank(""), &bank = bar.bank(tube(6));
  ASSERT_GT(bank.mode_count(), alone.mode_count()) << "the tube's own modes";
  for (std::size_t m = 0; m < alone.mode_count(); ++m) {
    double nearest = 1e9, decay = 0;
    for (std::size_t n = 0; n < bank.mode_count(); ++n) {
      if (bank.decay_per_s[n] > 2 || std::abs(bank.frequency_hz[n] - alone.frequency_hz[m]) > nearest) continue;
      nearest = std::abs(bank.frequency_hz[n] - alone.frequency_hz[m]);
      decay = bank.decay_per_s[n];
    }
    EXPECT_LT(nearest / alone.frequency_hz[m], 1e-6);
    EXPECT_NEAR(decay / alone.decay_per_s[m], 1, 1e-4);
  }
}

// What the two modes of one bake tell of bar and tube gives the modes of another bake, and the bar alone.
void expect_tuned_tube_is_that_of_a_bake(TubedBar& bar) {
  const modal::Bank &bank = bar.bank(tube(0.015)), &wanted = bar.bank(tube(0.015, "detune_cents = -30\n"));
  const auto same = modal::at_tuning(bank, {}), there = modal::at_tuning(bank, {.detune_cents = -30}),
             back = modal::at_tuning(wanted, {.detune_cents = 30}), closed = modal::at_tuning(bank, {.opening = 0});
  ASSERT_TRUE(same && there && back && closed) << same.error().message;
  const auto expect_alike = [](const modal::Bank& tuned, const modal::Bank& from_bake, double cents, double decay,
                               double db, const char* what) {
    const std::vector<std::size_t> a = fundamentals(tuned), b = fundamentals(from_bake);
    ASSERT_EQ(a.size(), 2u) << what;
    ASSERT_EQ(b.size(), 2u) << what;
    for (std::size_t n = 0; n < 2; ++n) {
      const double louder = gain_db(tuned, a[n], from_bake, b[n]);
      std::printf("%s: %.4f Hz %.4f 1/s, bake %.4f Hz %.4f 1/s, %+.2f dB\n", what, tuned.frequency_hz[a[n]],
                  tuned.decay_per_s[a[n]], from_bake.frequency_hz[b[n]], from_bake.decay_per_s[b[n]], louder);
      EXPECT_NEAR(1200 * std::log2(tuned.frequency_hz[a[n]] / from_bake.frequency_hz[b[n]]), 0, cents) << what;
      EXPECT_NEAR(tuned.decay_per_s[a[n]] / from_bake.decay_per_s[b[n]], 1, decay) << what;
      EXPECT_NEAR(rms_shape(tuned, a[n]) / rms_shape(from_bake, b[n]), 1, decay) << what;
      EXPECT_NEAR(louder, 0, db) << what;
    }
  };
  expect_alike(same->bank, bank, 1e-3, 1e-5, 0.01, "as baked");
  expect_alike(there->bank, wanted, 1, 0.02, 0.5, "30 cents lower");
  expect_alike(back->bank, bank, 1, 0.02, 0.5, "in tune again");
  EXPECT_NEAR(closed->bank.decay_per_s[fundamentals(closed->bank)[0]], kBareDecay_per_s, 1e-3);
  for (std::size_t m = 0; m < there->bank.mode_count(); ++m)
    EXPECT_NEAR(there->bank.losses[m].total_per_s() / there->bank.decay_per_s[m], 1, 1e-9);
}

void expect_kept_in_the_bank_or_refused(TubedBar& bar) {
  const fs::path file = bar.folder() / "bar.glb";
  ASSERT_TRUE(modal::write_bank(bar.bank(tube(0.015, "detune_cents = -30\n")), file));
  const auto read = modal::read_bank(file);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->provenance.resonators.size(), 1u);
  const modal::ResonatorNote& note = read->provenance.resonators[0];
  EXPECT_NEAR(note.diameter_m, 0.04, 1e-9);
  EXPECT_NEAR(1200 * std::log2(note.frequency_hz / 220), -30, 0.5);
  EXPECT_NEAR(note.end_correction_m, 0.82 * 0.02, 0.06 * 0.02);
  EXPECT_NE(bar.refusal(tube(-0.005)).find("cut each other"), std::string::npos);
  EXPECT_NE(bar.refusal(tube(0.015, "tuned_to = 19\n")).find("mode 19"), std::string::npos);
  EXPECT_NE(bar.refusal(tube(0.015, "tuned_to = 20000\n")).find("shorter than its radius"), std::string::npos);
}

// One test, so that each of the six bars is baked once.
TEST(BarWithTube, RingsAsThePrototypeSaysAndAsBakesInItsTuningsDo) {
  TubedBar bar;
  expect_louder_and_shorter_as_the_gap_closes(bar);
  expect_far_tube_changes_nothing(bar);
  expect_tuned_tube_is_that_of_a_bake(bar);
  expect_kept_in_the_bank_or_refused(bar);
}

}  // namespace
}  // namespace ringdown::resonator_test
