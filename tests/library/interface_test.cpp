// Promises of the C header: arrays of banks, sizes of older and later structs, levels, and mixers that know nothing
// of each other. errors_test.cpp has what is refused.
#include "tests/library/mixer_of_banks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

namespace ringdown::test::interface_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<double, 3> kTop{0, 0, 0.1}, kBlow{0, 0, -0.02};

bool says(const ringdown_error& error, const std::string& part) {
  return std::string(error.sentence).find(part) != std::string::npos;
}

TEST(LibraryBank, SaysThePitchAndWhereItIsFrom) {
  const TemporaryFolder folder;
  modal::Bank bank = single_mode_bank(440, 2);
  const auto pitch_of = [&] {
    EXPECT_TRUE(modal::write_bank(bank, folder / "a.glb"));
    ringdown_bank* opened = nullptr;
    EXPECT_EQ(ringdown_bank_open((folder / "a.glb").c_str(), &opened, nullptr), RINGDOWN_OK);
    std::pair<double, ringdown_pitch> pitch;
    EXPECT_EQ(ringdown_bank_pitch(opened, &pitch.first, &pitch.second), RINGDOWN_OK);
    ringdown_bank_release(opened);
    return pitch;
  };
  EXPECT_EQ(pitch_of(), std::pair(440.0, RINGDOWN_PITCH_ESTIMATED));
  bank.pitch_hz = 220;
  EXPECT_EQ(pitch_of(), std::pair(220.0, RINGDOWN_PITCH_STATED));
  bank.pitch_hz.reset();
  bank.decay_per_s = {1000};
  EXPECT_EQ(pitch_of(), std::pair(440.0, RINGDOWN_PITCH_NONE)) << "the frequency that comes closest";
  double hz = 0;
  ringdown_pitch kind{};
  EXPECT_EQ(ringdown_bank_pitch(nullptr, &hz, &kind), RINGDOWN_BAD_INPUT);
}

TEST(LibraryBank, GivesTheArraysOfTheFile) {
  const TemporaryFolder folder;
  const modal::Bank bank = random_bank(3, 25, 12);
  ASSERT_TRUE(modal::write_bank(bank, folder / "a.glb"));
  ringdown_error error;
  ringdown_bank* opened = nullptr;
  ASSERT_EQ(ringdown_bank_open((folder / "a.glb").c_str(), &opened, &error), RINGDOWN_OK) << error.sentence;
  ringdown_bank_info info{};
  info.size = sizeof info;
  ASSERT_EQ(ringdown_bank_describe(opened, &info), RINGDOWN_OK);
  ASSERT_EQ(info.modes, bank.mode_count());
  ASSERT_EQ(info.points, bank.point_count());
  ASSERT_EQ(info.triangles, bank.triangles.size());
  const auto read = modal::read_bank(folder / "a.glb");
  ASSERT_TRUE(read);
  for (std::size_t m = 0; m < info.modes; ++m) {
    EXPECT_EQ(ringdown_bank_frequencies_hz(opened)[m], read->frequency_hz[m]);
    EXPECT_EQ(ringdown_bank_decays_per_s(opened)[m], read->decay_per_s[m]);
    for (std::size_t p = 0; p < info.points; ++p) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(ringdown_bank_shapes(opened)[(m * info.points + p) * 3 + c], read->shape(m, p)[c]);
      }
    }
  }
  std::vector<double> levels(info.modes);
  EXPECT_EQ(ringdown_bank_levels_pa(opened, levels.data()), RINGDOWN_OK);
  for (std::size_t m = 0; m < info.modes; ++m) {  // even_field(): pressure = rho omega |F|
    const double omega = 2 * M_PI * bank.frequency_hz[m];
    EXPECT_NEAR(levels[m], kLoudness * modal::kFullScale_pa * omega, 1e-5 * levels[m]);
  }
  const std::array<double, 6> directions{1, 0, 0, 0, -2, 0};
  std::array<float, 4> field{};
  ASSERT_EQ(ringdown_bank_far_field(opened, 0, directions.data(), 2, field.data(), &error), RINGDOWN_OK);
  EXPECT_FLOAT_EQ(field[0], field[2]);
  EXPECT_NE(ringdown_bank_far_field(opened, 25, directions.data(), 2, field.data(), &error), RINGDOWN_OK);
  EXPECT_TRUE(says(error, "mode is 25")) << error.sentence;
  ringdown_bank_release(opened);
}

TEST(LibraryBank, OfMemoryIsTheBankOfTheFile) {
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(random_bank(3, 25, 12), folder / "a.glb"));
  std::ifstream file(folder / "a.glb", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  ringdown_error error;
  ringdown_bank* bank = nullptr;
  ASSERT_EQ(ringdown_bank_parse(bytes.data(), bytes.size(), nullptr, &bank, &error), RINGDOWN_OK) << error.sentence;
  ringdown_bank_info info{};
  info.size = sizeof info;
  ASSERT_EQ(ringdown_bank_describe(bank, &info), RINGDOWN_OK);
  EXPECT_EQ(info.modes, 25u);
  ringdown_bank_release(bank);
  bytes.resize(bytes.size() / 2);
  EXPECT_EQ(ringdown_bank_parse(bytes.data(), bytes.size(), "half", &bank, &error), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "half")) << error.sentence;
}

// A struct of an older header ends earlier; one of a later header has members that we do not know.
TEST(LibraryVersions, ShorterStructsKeepDefaultsAndLongerOnesMustBeZeroThere) {
  ringdown_error error;
  ringdown_mixer* mixer = nullptr;
  struct {
    ringdown_settings known;
    double later;
  } settings;
  ringdown_settings_init(&settings.known, sizeof settings);
  EXPECT_EQ(settings.known.size, sizeof settings);
  EXPECT_EQ(settings.later, 0);
  EXPECT_EQ(ringdown_mixer_create(&settings.known, &mixer, &error), RINGDOWN_OK) << error.sentence;
  ringdown_mixer_destroy(mixer);
  settings.later = 1;
  EXPECT_EQ(ringdown_mixer_create(&settings.known, &mixer, &error), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "later library")) << error.sentence;

  ringdown_settings old{};
  ringdown_settings_init(&old, offsetof(ringdown_settings, limiter_db));
  EXPECT_EQ(old.limiter_db, 0) << "beyond its size nothing is written";
  ASSERT_EQ(ringdown_mixer_create(&old, &mixer, &error), RINGDOWN_OK) << error.sentence;
  EXPECT_GT(ringdown_latency(mixer), 0u) << "the limiter is on by default";
  ringdown_mixer_destroy(mixer);

  ringdown_settings wrong{};
  EXPECT_EQ(ringdown_mixer_create(&wrong, &mixer, &error), RINGDOWN_BAD_INPUT);
  EXPECT_TRUE(says(error, "sizeof")) << error.sentence;

  MixerOfBanks banks(1);
  ringdown_status status{};
  status.size = offsetof(ringdown_status, late);
  status.late = 77;
  ASSERT_EQ(ringdown_get_status(banks.get(), &status), RINGDOWN_OK);
  EXPECT_EQ(status.late, 77u);
}

TEST(LibrarySettings, AreRefusedOutOfRange) {
  const auto refused = [](auto set) {
    ringdown_settings settings;
    ringdown_settings_init(&settings, sizeof settings);
    set(settings);
    ringdown_mixer* mixer = nullptr;
    ringdown_error error;
    const auto result = ringdown_mixer_create(&settings, &mixer, &error);
    EXPECT_EQ(mixer, nullptr);
    return result != RINGDOWN_OK;
  };
  EXPECT_TRUE(refused([](auto& s) { s.sample_rate_hz = kNan; }));
  EXPECT_TRUE(refused([](auto& s) { s.sample_rate_hz = 100; }));
  EXPECT_TRUE(refused([](auto& s) { s.limiter_db = 3; }));
  EXPECT_TRUE(refused([](auto& s) { s.ambisonic_order = 4; }));
  EXPECT_TRUE(refused([](auto& s) { s.threads = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.full_scale_pa = 0; }));
  EXPECT_TRUE(refused([](auto& s) { s.head = "/nonexistent.sofa"; }));
}

TEST(LibraryObjects, MaterialSizeHoldAndRemovalAreHeard) {
  MixerOfBanks mixer(1);
  ringdown_error error;
  std::array<float, 4800> left, right;
  const auto energy = [&] {
    ringdown_strike(mixer.get(), 0, 0, kTop.data(), kBlow.data(), 0, &error);
    ringdown_render(mixer.get(), left.data(), right.data(), left.size());
    double sum = 0;
    for (std::size_t i = left.size() / 2; i < left.size(); ++i) sum += left[i] * static_cast<double>(left[i]);
    ringdown_clear(mixer.get(), 0, 0, 0, &error);
    for (int i = 0; i < 3; ++i) ringdown_render(mixer.get(), left.data(), right.data(), left.size());
    ringdown_collect(mixer.get());
    return sum;
  };
  const double free = energy();
  ASSERT_GT(free, 0);
  ASSERT_EQ(ringdown_hold(mixer.get(), 0, 0, 0, kTop.data(), std::array<double, 3>{}.data(), 1e4, &error), RINGDOWN_OK);
  EXPECT_LT(energy(), 0.5 * free);
  ASSERT_EQ(ringdown_hold(mixer.get(), 0, 0, 0, kTop.data(), std::array<double, 3>{}.data(), 0, &error), RINGDOWN_OK);
  EXPECT_NEAR(energy(), free, 1e-6 * free);
  ringdown_material material;
  ringdown_material_init(&material, sizeof material);
  material.beta = material.alpha = 100;
  ASSERT_EQ(ringdown_set_material(mixer.get(), 0, &material, &error), RINGDOWN_OK) << error.sentence;
  EXPECT_LT(energy(), 0.5 * free);
  ASSERT_EQ(ringdown_remove(mixer.get(), 0, &error), RINGDOWN_OK);
  EXPECT_EQ(ringdown_remove(mixer.get(), 0, &error), RINGDOWN_BAD_INPUT);
}

TEST(LibraryRender, InputsPushAndAmbisonicChannelsAreHeard) {
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.ambisonic_order = 1;
  MixerOfBanks mixer(1, &settings);
  ringdown_error error;
  ASSERT_EQ(ringdown_excite(mixer.get(), 2, 0, kTop.data(), kTop.data(), &error), RINGDOWN_OK) << error.sentence;
  EXPECT_EQ(ringdown_excite(mixer.get(), 4, 0, kTop.data(), kTop.data(), &error), RINGDOWN_BAD_INPUT);
  std::array<float, 512> left, w, input{};
  input[10] = 100;
  ringdown_block block{};
  block.size = sizeof block;
  block.frames = left.size();
  block.mix[0] = left.data();
  block.ambisonics[0] = w.data();
  block.inputs[2] = input.data();
  ringdown_render_all(mixer.get(), &block);
  EXPECT_TRUE(std::ranges::any_of(w, [](float sample) { return sample != 0; }));
  EXPECT_TRUE(std::all_of(w.begin(), w.begin() + 10, [](float sample) { return sample == 0; }));
}

// The header's figure: an object in the middle has 1/sqrt(2) of full scale on each side, and one at the left all of it
// there.
TEST(LibraryRender, SidesShareThePowerOfAnObjectInTheMiddle) {
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.limiter_db = 1;
  const TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(single_mode_bank(1000, 0.01), folder / "one.glb"));
  for (const auto& [pan, wanted_left, wanted_right] :
       {std::array{0.0, 0.25 * M_SQRT1_2, 0.25 * M_SQRT1_2}, std::array{-1.0, 0.25, 0.0}, std::array{1.0, 0.0, 0.25}}) {
    ringdown_error error;
    ringdown_mixer* mixer = nullptr;
    ringdown_bank* bank = nullptr;
    std::uint32_t object = 0;
    ASSERT_EQ(ringdown_mixer_create(&settings, &mixer, &error), RINGDOWN_OK) << error.sentence;
    ASSERT_EQ(ringdown_bank_open((folder / "one.glb").c_str(), &bank, &error), RINGDOWN_OK) << error.sentence;
    ASSERT_EQ(ringdown_add(mixer, nullptr, bank, &object, &error), RINGDOWN_OK) << error.sentence;
    ringdown_bank_release(bank);
    std::array<float, 9600> left, right;
    ASSERT_EQ(ringdown_pan(mixer, 0, object, pan, &error), RINGDOWN_OK) << error.sentence;
    ringdown_render(mixer, left.data(), right.data(), left.size());
    ASSERT_EQ(ringdown_ring(mixer, 0, object, 0, 1, 0.25, &error), RINGDOWN_OK) << error.sentence;
    ringdown_render(mixer, left.data(), right.data(), left.size());
    EXPECT_NEAR(*std::ranges::max_element(left), wanted_left, 0.002) << pan;
    EXPECT_NEAR(*std::ranges::max_element(right), wanted_right, 0.002) << pan;
    ringdown_mixer_destroy(mixer);
  }
}

// Mixers side by side in threads of their own play what one alone plays.
TEST(LibraryInstances, AreIndependent) {
  const auto play = [](std::uint32_t seed) {
    MixerOfBanks mixer(2);
    std::vector<float> left(9600), right(9600);
    ringdown_error error;
    for (std::size_t begin = 0; begin < left.size(); begin += 96) {
      const std::array<double, 3> blow{0, 0, -0.001 * (seed + 1)};
      ringdown_strike(mixer.get(), static_cast<std::int64_t>(begin), seed % 2, kTop.data(), blow.data(), 0, &error);
      ringdown_render(mixer.get(), left.data() + begin, right.data() + begin, 96);
    }
    return left;
  };
  constexpr std::uint32_t kMixers = 6;
  std::vector<std::vector<float>> alone, together(kMixers);
  for (std::uint32_t n = 0; n < kMixers; ++n) alone.push_back(play(n));
  {
    std::vector<std::jthread> threads;
    for (std::uint32_t n = 0; n < kMixers; ++n) threads.emplace_back([&, n] { together[n] = play(n); });
  }
  EXPECT_EQ(alone, together);
}

}  // namespace
}  // namespace ringdown::test::interface_test
