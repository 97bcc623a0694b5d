// The built plug-ins in small hosts: what clap-validator asks of a plug-in, and the same samples as libringdown's.
#include "tests/plugin/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace ringdown::test;

constexpr double kRate_hz = 48000;
constexpr std::size_t kObject = 1, kTuning = 2, kRootKey = 3, kSize = 4, kContact = 9, kEven = 10, kGain = 11,
                      kWidth = 13, kRelease = 14, kTouch = 15, kBendRange = 16, kEmbed = 18;  // 0 is an output
constexpr double kVibraphoneKey = 9, kGlockenspiel = 25, kSteelPlate = 35;
constexpr int kBow = 6;

struct Format {
  const char* name;
  std::unique_ptr<PluginHost> (*open)();
};
class EveryFormat : public testing::TestWithParam<Format> {
 protected:
  std::unique_ptr<PluginHost> open() { return GetParam().open(); }
};
INSTANTIATE_TEST_SUITE_P(, EveryFormat,
                         testing::Values(Format{"clap", open_clap}, Format{"lv2", open_lv2}, Format{"vst3", open_vst3}),
                         [](const auto& format) { return std::string(format.param.name); });

// The glockenspiel at its own pitch, as set_plain() has it.
void set_glockenspiel(PluginHost& host) {
  set_plain(host);
  host.set_parameter(kObject, kGlockenspiel);
  host.set_parameter(kRootKey, 72);
}

TEST_P(EveryFormat, PlaysTheSamplesOfTheLibraryAtTheSameFrames) {
  const Score score = random_notes(60, 48000, 1);
  const auto host = open();
  set_glockenspiel(*host);
  host->activate(kRate_hz);
  const Sound expected = LibraryInstrument(Rig{}).play(score);
  EXPECT_GT(power(expected.left), 1e-3);
  EXPECT_LT(difference_db(expected, play(*host, score, {256})), -120);
}

// Mallets, the bow and objects change while others ring.
TEST_P(EveryFormat, PlaysTheSamplesOfTheLibraryWithEachMalletAndThroughChangesOfTheObject) {
  std::vector<Rig> rigs;
  for (int mallet = 0; mallet <= kBow; ++mallet) rigs.push_back({.mallet = mallet});
  for (const int mallet : {2, kBow}) rigs.push_back({kVibraphoneKey, "vibraphone-key", 72, mallet});
  rigs.push_back({.mallet = 4});
  const auto host = open();
  set_plain(*host);
  host->activate(kRate_hz);
  EXPECT_LT(largest_difference_db(*host, rigs), -120);
}

// A change of the root key gives key after key another size. From 60 to 72, key 72 gets the size that key 60 still has,
// so the mixer founds a group for the modes that both then share, and plays the key by the group's sums from then on.
// Sums are rounded in another way than an object's own states. From 60 at 1.03 times the size, no two keys are ever
// equal.
TEST_P(EveryFormat, AChangeOfTheRootKeyWhileItRunsLeavesTheSamplesOfTheLibraryButForSharedSums) {
  const Rig rig{};
  const Score score = random_notes(24, 48 * 256, 0);
  std::map<double, double> difference;  // by the size before
  for (const double size : {1.0, 1.03}) {
    const auto host = open();
    set_plain(*host);
    host->set_parameter(kObject, rig.object);
    host->set_parameter(kSize, size);
    host->activate(kRate_hz);
    LibraryInstrument library(rig);
    host->set_parameter(kRootKey, rig.root_key);
    host->set_parameter(kSize, 1);
    for (int turn = 0; turn < 3; ++turn) {  // as the worker may get no processor in between
      library.play({{}, 256});
      play(*host, {{}, 256}, {256});
      EXPECT_TRUE(host->load(host->save()));
    }
    const Sound expected = library.play(score);
    difference[size] = difference_db(expected, play(*host, score, {256}));
  }
  EXPECT_LT(difference[1.03], -120);
  EXPECT_LT(difference[1], -100);
}

// 10,000 notes in 10 s on 112 keys of a plate with 126 modes.
TEST_P(EveryFormat, PlaysTenThousandNotesOnAsManyModesAsTheLibraryDoes) {
  Score score{{}, 480000};
  std::mt19937 random(8);
  for (int i = 0; i < 10'000; ++i) {
    const auto key = static_cast<std::uint8_t>(16 + (i < 112 ? i : static_cast<int>(random() % 112)));
    // Large plates are struck more softly, so that small ones are not lost beside them.
    const double softer = std::min(1.0, std::exp2((key - 80) / 8.0));
    const auto velocity = static_cast<std::uint8_t>(1 + softer * static_cast<double>(random() % 127));
    // All keys sound within 13 ms.
    const auto frame = static_cast<std::uint32_t>(random() % (i < 112 ? 600 : score.frames - 4800));
    score.events.push_back({frame, {0x90, key, velocity}});
  }
  std::sort(score.events.begin(), score.events.end());
  const auto host = open();
  set_glockenspiel(*host);
  host->set_parameter(kObject, kSteelPlate);
  host->set_parameter(kRootKey, 80);
  host->activate(kRate_hz);
  const Sound expected = LibraryInstrument(Rig{kSteelPlate, "steel-plate", 80}).play(score);
  EXPECT_GT(power(expected.left), 1e-3);
  const double difference = difference_db(expected, play(*host, score, {256}));
  EXPECT_LT(difference, -120);
  RecordProperty("difference_db", std::to_string(difference));
  EXPECT_GE(expected.max_modes, 10'000u);
  std::printf("%zu notes, %u modes at once: %.1f dB from the library\n", score.events.size(), expected.max_modes,
              difference);
}

TEST_P(EveryFormat, ReleasesAndPedalsArrive) {
  const auto host = open();
  host->set_parameter(kObject, kGlockenspiel);
  host->set_parameter(kRelease, 0.02);
  host->activate(kRate_hz);
  const auto power_after = [&](std::array<std::uint8_t, 3> message) {
    play(*host, {{{0, message}}, 2048}, {256});
    return power(play(*host, {{}, 512}, {256}).left);
  };
  EXPECT_GT(power_after({0x90, 69, 127}), 1e-4);
  EXPECT_EQ(power_after({0x80, 69, 0}), 0);
  power_after({0x90, 69, 127});
  power_after({0xb0, 64, 127});
  EXPECT_GT(power_after({0x80, 69, 0}), 1e-4) << "the sustain pedal keeps it";
  EXPECT_EQ(power_after({0xb0, 64, 0}), 0);
}

TEST_P(EveryFormat, OddBlocksGiveTheSameSound) {
  const Score score = random_notes(20, 12000, 2);
  const auto host = open();
  set_glockenspiel(*host);
  host->activate(kRate_hz);
  const Sound expected = play(*host, score, {64});
  host->activate(kRate_hz);  // and nothing of before is left
  EXPECT_LT(difference_db(expected, play(*host, score, {1, 255, 3, 4096, 17})), -100);
}

TEST_P(EveryFormat, AStateBringsBackEveryParameterAndTheSound) {
  const Score score = random_notes(10, 9000, 3);
  const auto first = open();
  std::mt19937 random(4);
  std::vector<double> values;
  for (std::size_t i = 0; i < first->parameters(); ++i) {
    const bool is_switch = i >= kBendRange || i == kTuning || i == kEven;
    if (i == 0) {
      values.push_back(0);
      continue;
    }
    values.push_back(i == kObject ? 13 : (i == kRootKey ? 64 : (is_switch ? 1 : 0.5 + (random() % 100) / 100.0)));
    first->set_parameter(i, values.back());
  }
  first->activate(kRate_hz);
  const Sound expected = play(*first, score, {256});
  EXPECT_GT(power(expected.left), 1e-9);
  const std::string state = first->save();
  const auto second = open();
  ASSERT_TRUE(second->load(state));
  second->activate(kRate_hz);
  for (std::size_t i = 1; i < values.size(); ++i) {
    EXPECT_NEAR(second->parameter(i), values[i], 1e-4) << i;
  }
  EXPECT_EQ(second->save(), state);
  EXPECT_LT(difference_db(expected, play(*second, score, {256})), -100);
}

TEST_P(EveryFormat, ParametersInAnyOrderGiveTheSameSound) {
  const Score score = random_notes(10, 6000, 5);
  std::vector<std::pair<std::size_t, double>> values = {{kObject, 13}, {kTuning, 1}, {kRootKey, 70}, {kSize, 1.5},
                                                        {kContact, 1}, {kGain, -3},  {kWidth, 80}};
  std::vector<Sound> sounds;
  std::mt19937 random(6);
  for (int turn = 0; turn < 3; ++turn) {
    const auto host = open();
    for (const auto& [number, value] : values) host->set_parameter(number, value);
    host->activate(kRate_hz);
    sounds.push_back(play(*host, score, {128}));
    std::shuffle(values.begin(), values.end(), random);
  }
  EXPECT_GT(power(sounds[0].left), 1e-6);
  EXPECT_LT(difference_db(sounds[0], sounds[1]), -100);
  EXPECT_LT(difference_db(sounds[0], sounds[2]), -100);
}

TEST_P(EveryFormat, RandomParametersWhileItPlaysNeverGiveWhatIsNotANumber) {
  const auto host = open();
  host->activate(kRate_hz);
  std::mt19937 random(7);
  std::vector<float> left(512), right(512);
  for (int block = 0; block < 60; ++block) {
    for (int i = 0; i < 4; ++i) {
      const std::size_t number = 1 + random() % (host->parameters() - 1);
      // Objects are the small ones, and not each block another: loading takes time.
      const double value = number == kObject ? 10.0 + random() % 3 : (random() % 2000) / 100.0 - 2;
      if (number != kObject || block % 10 == 0) host->set_parameter(number, value);
    }
    const std::uint32_t frames = 1 + random() % 512;
    host->render(
        {{0, {0x90, static_cast<std::uint8_t>(random() % 128), 100}},
         {frames - 1, {0xe0, static_cast<std::uint8_t>(random() % 128), static_cast<std::uint8_t>(random() % 128)}},
         {frames - 1, {0xd0, static_cast<std::uint8_t>(random() % 128), 0}}},
        left.data(), right.data(), frames);
    for (std::uint32_t i = 0; i < frames; ++i) ASSERT_TRUE(std::isfinite(left[i]) && std::isfinite(right[i])) << block;
  }
}

TEST_P(EveryFormat, ManyInstancesLiveSideBySideAndComeAndGo) {
  std::vector<std::unique_ptr<PluginHost>> hosts;
  const Score score{{{0, {0x90, 60, 100}}}, 2000};
  std::vector<Sound> sounds;
  for (int i = 0; i < 4; ++i) {
    hosts.push_back(open());
    hosts.back()->set_parameter(kObject, 13);
    hosts.back()->activate(kRate_hz);
  }
  hosts.erase(hosts.begin() + 1);
  for (auto& host : hosts) sounds.push_back(play(*host, score, {100}));
  EXPECT_GT(power(sounds[0].left), 1e-6);
  EXPECT_LT(difference_db(sounds[0], sounds[1]), -120);
  EXPECT_LT(difference_db(sounds[0], sounds[2]), -120);
  open();  // and goes without having been active
}

TEST_P(EveryFormat, ASessionThatHoldsTheBankNeedsNoFile) {
  const Score score{{{0, {0x90, 60, 100}}}, 4000};
  const auto first = open();
  first->set_parameter(kObject, 13);
  first->set_parameter(kEmbed, 1);
  first->activate(kRate_hz);
  const Sound expected = play(*first, score, {100});
  const std::string state = first->save();
  EXPECT_GT(state.size(), 15000u);
  const char* const presets = std::getenv("RINGDOWN_PRESETS");
  const std::string before = presets ? presets : "";
  setenv("RINGDOWN_PRESETS", "/nowhere", 1);
  const auto second = open();
  ASSERT_TRUE(second->load(state));
  second->activate(kRate_hz);
  const Sound sound = play(*second, score, {100});
  if (presets) {
    setenv("RINGDOWN_PRESETS", before.c_str(), 1);
  } else {
    unsetenv("RINGDOWN_PRESETS");
  }
  EXPECT_GT(power(expected.left), 1e-6);
  EXPECT_LT(difference_db(expected, sound), -100);
}

// How much of a frequency there is.
double part_of(const Sound& sound, double frequency_hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < sound.left.size(); ++i) {
    sum += static_cast<double>(sound.left[i]) *
           std::polar(1.0, 2 * std::numbers::pi * frequency_hz * static_cast<double>(i) / kRate_hz);
  }
  return std::abs(sum);
}

constexpr int kTuningExpression = 2, kBrightness = 5, kPressure = 6;  // CLAP's note expressions

TEST(Clap, NoteExpressionsTuneAKeyAndPressOnIt) {
  const auto host = open_clap();
  host->set_parameter(kObject, kGlockenspiel);
  host->set_parameter(kRelease, kRingsOn);
  host->activate(kRate_hz);
  const auto settled = [&] { ASSERT_TRUE(host->load(host->save())); };  // the worker does its work before it returns
  const Score note{{{0, {0x90, 69, 100}}}, 4800}, silence{{}, 4800};
  const Sound plain = play(*host, note, {256});
  EXPECT_GT(part_of(plain, 440), 5 * part_of(plain, 440 * std::exp2(5 / 12.0)));
  express(*host, kTuningExpression, 69, 5);
  play(*host, {{}, 64}, {64});
  settled();
  play(*host, {{}, 64}, {64});
  const Sound tuned = play(*host, silence, {256});
  EXPECT_GT(part_of(tuned, 440 * std::exp2(5 / 12.0)), 5 * part_of(tuned, 440));
  host->set_parameter(kTouch, 100);
  express(*host, kPressure, 69, 1);
  play(*host, {{}, 64}, {64});
  settled();
  play(*host, silence, {256});
  EXPECT_LT(power(play(*host, silence, {256}).left), 0.1 * power(tuned.left));
}

TEST(Vst3, NoteExpressionsTuneAKey) {
  const auto host = open_vst3();
  host->set_parameter(kObject, kGlockenspiel);
  host->set_parameter(kRelease, kRingsOn);
  host->activate(kRate_hz);
  const double higher_hz = 440 * std::exp2(5 / 12.0);
  const Sound plain = play(*host, {{{0, {0x90, 69, 100}}}, 4800}, {256});
  EXPECT_GT(part_of(plain, 440), 5 * part_of(plain, higher_hz));
  express_vst3(*host, kTuningExpression, 70, 0.9);  // of a note that there is not
  express_vst3(*host, kTuningExpression, 69, 0.5 + 5 / 240.0);
  play(*host, {{}, 64}, {64});
  ASSERT_TRUE(host->load(host->save()));  // the worker does its work before it returns
  play(*host, {{}, 64}, {64});
  const Sound tuned = play(*host, {{}, 4800}, {256});
  EXPECT_GT(part_of(tuned, higher_hz), 5 * part_of(tuned, 440));
}

TEST(Vst3, BrightnessHardensTheNextBlow) {
  std::vector<double> loudness;
  for (const double brightness : {0.5, 0.0, 1.0}) {
    const auto host = open_vst3();
    host->set_parameter(kObject, kGlockenspiel);
    host->set_parameter(kContact, 1);
    host->activate(kRate_hz);
    play(*host, {{{0, {0x90, 84, 1}}}, 256}, {256});  // the note by which the host names the key
    express_vst3(*host, kBrightness, 84, brightness);
    play(*host, {{}, 64}, {64});
    loudness.push_back(power(play(*host, {{{0, {0x90, 84, 100}}}, 4800}, {256}).left));
  }
  EXPECT_LT(loudness[1], 0.5 * loudness[0]);
  EXPECT_GT(loudness[2], 2 * loudness[0]);
}

// Sessions as version 0.1.0 saved them before parameters had units and groups.
const std::string kSaved =
    std::string("__dpf_state_begin__|embedded||file||__dpf_state_end__|__dpf_parameters_begin__|object|12|tuning|1|") +
    "root_key|64|size|1.5|stiffness|2|density|0.5|loss|3|strike_point|25|contact_time|0.75|even_loudness|0|gain|-6|" +
    "pan|-20|width|80|release|1.25|hand|10|bend_range|12|mpe|1|embed|0|__dpf_parameters_end__|\xfe|";
const std::vector<double> kSavedValues = {12, 1, 64, 1.5, 2, 0.5, 3, 25, 0.75, 0, -6, -20, 80, 1.25, 10, 12, 1, 0};

TEST_P(EveryFormat, SessionsOfEarlierVersionsLoad) {
  std::string state = kSaved;
  std::replace(state.begin(), state.end(), '|', '\0');
  if (std::string(GetParam().name) == "lv2") {  // whose hosts save the values of ports
    state.clear();
    for (const double value : kSavedValues) state += std::to_string(value) + "\n";
  }
  const auto host = open();
  ASSERT_TRUE(host->load(state));
  for (std::size_t i = 0; i < kSavedValues.size(); ++i) EXPECT_NEAR(host->parameter(i + 1), kSavedValues[i], 1e-5) << i;
}

TEST(Clap, BrightnessHardensTheNextBlowAndModulationIsHeard) {
  const Score note{{{0, {0x90, 84, 100}}}, 4800};
  std::vector<double> loudness;
  for (const double brightness : {0.5, 0.0, 1.0}) {
    const auto host = open_clap();
    host->set_parameter(kObject, kGlockenspiel);
    host->set_parameter(kContact, 1);
    host->activate(kRate_hz);
    express(*host, kBrightness, -1, brightness);
    modulate(*host, kGain, -20);
    loudness.push_back(100 * power(play(*host, note, {256}).left));
  }
  EXPECT_LT(loudness[1], 0.5 * loudness[0]);
  EXPECT_GT(loudness[2], 2 * loudness[0]);
  EXPECT_GT(loudness[0], 1e-5);
}

// DPF hands over none of CLAP and VST3, and of VST3 an event of undefined bytes in its place.
TEST_P(EveryFormat, SystemExclusiveMessagesTuneKeys) {
  const auto host = open();
  host->set_parameter(kObject, kGlockenspiel);
  host->set_parameter(kRelease, kRingsOn);
  host->activate(kRate_hz);
  std::vector<float> left(64), right(64);
  // Key 60 gets the pitch of key 72.
  host->render({{0, {}, {0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 60, 72, 0x00, 0x00, 0xf7}}}, left.data(),
               right.data(), 64);
  host->deactivate();
  host->activate(kRate_hz);  // the worker has come
  const Sound tuned = play(*host, {{{0, {0x90, 60, 100}}}, 4800}, {256});
  const auto other = open();
  other->set_parameter(kObject, kGlockenspiel);
  other->set_parameter(kRelease, kRingsOn);
  other->activate(kRate_hz);
  const Sound expected = play(*other, {{{0, {0x90, 72, 100}}}, 4800}, {256});
  const auto channel_sum = [](const Sound& sound) {
    std::vector<float> sum(sound.left.size());
    std::transform(sound.left.begin(), sound.left.end(), sound.right.begin(), sum.begin(), std::plus<>());
    return sum;
  };
  const std::vector<float> a = channel_sum(tuned), b = channel_sum(expected);
  double similar = 0;
  for (std::size_t i = 0; i < a.size(); ++i) similar += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  EXPECT_GT(similar / std::sqrt(power(a) * power(b)), 0.999);
}

TEST(Clap, BrokenStatesAreRefusedOrIgnored) {
  const auto host = open_clap();
  const std::string state = host->save();
  for (const std::string& broken : {std::string(), std::string("nonsense"), state.substr(0, state.size() / 2)}) {
    EXPECT_FALSE(host->load(broken)) << broken.size();
  }
  std::mt19937 random(8);
  for (int turn = 0; turn < 50; ++turn) {
    std::string changed = state;
    for (int i = 0; i < 5; ++i) changed[random() % changed.size()] = static_cast<char>(random());
    host->load(changed);
  }
  EXPECT_TRUE(host->load(state));
  host->activate(kRate_hz);
  EXPECT_GT(power(play(*host, {{{0, {0x90, 60, 100}}}, 2000}, {256}).left), 1e-6);
}

}  // namespace
