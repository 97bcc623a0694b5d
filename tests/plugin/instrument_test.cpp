// The instrument without a plug-in format: what each parameter and message does to the sound.
#include "engine/modal/bank_file.h"
#include "tests/plugin/instrument_fixture.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace ringdown::plugin {
namespace {

TEST_F(InstrumentTest, KeysHaveConcertPitch) {
  for (const auto& [key, expected_hz] : {std::pair{69, 440.0}, {57, 220.0}, {81, 880.0}, {60, 261.6255653}}) {
    play(kControl, 120, 0);
    hear(1024);
    play(kOn, static_cast<std::uint8_t>(key), 100);
    EXPECT_NEAR(pitch_hz() / expected_hz, 1, 1e-4) << key;
  }
}

TEST(KeyPlan, TunedThingsAreTunedByTheirNotesAndTheirPlayersAreToldWhatChanged) {
  const auto plan_of = [](const std::string& preset) {
    const std::string path = RINGDOWN_SOURCE_DIR "/presets/banks/" + preset + ".glb";
    return plan_keys({path, path}, {}).value();
  };
  for (const auto& [name, hz] : {std::pair{"vibraphone-key", 220.0},
                                 {"xylophone-key", 440.0},
                                 {"tuning-fork", 440.0},
                                 {"glockenspiel-bar", 1046.5},
                                 {"wine-glass", 1136.2}}) {
    EXPECT_NEAR(plan_of(name).map.bodies[0].pitch_hz / hz, 1, 1e-3) << name;
  }
  const std::string notice = plan_of("xylophone-key").notice;
  EXPECT_NE(notice.find("440.0 Hz"), notice.npos) << notice;
  EXPECT_NE(notice.find("1320.2 Hz"), notice.npos) << "as before: " << notice;
  EXPECT_EQ(plan_of("glockenspiel-bar").notice, "") << "as it was";
}

TEST_F(InstrumentTest, NotesOfAMapShareABankAndHaveLevelsOfTheirOwn) {
  ASSERT_TRUE(modal::write_bank(test::leveled_bank(440, 2), folder_.path() / "glass.glb"));
  const auto map = [](double level_m) {
    return formatted(
        "[[note]]\nnote = 60\nobject = 'a'\nbank = 'glass'\nlevel_m = 0\n"
        "[[note]]\nnote = 62\nobject = 'b'\nbank = 'glass'\nlevel_m = {}\n",
        level_m);
  };
  const std::string path = folder_.write("notes.toml", map(0.06)).string();
  EXPECT_EQ(plan_keys({path, path}, {}).value().banks.size(), 1u);
  instrument_.set_file(path);
  settle();
  for (const auto& [key, level_m] : {std::pair{60, 0.0}, {62, 0.06}}) {
    play(kControl, 120, 0);
    hear(1024);
    play(kOn, static_cast<std::uint8_t>(key), 100);
    EXPECT_NEAR(pitch_hz(), 440 / std::sqrt(1 + test::kMassPerSquare * level_m * level_m), 0.1) << key;
  }
  const std::string over = folder_.write("over.toml", map(0.2)).string();
  EXPECT_NE(plan_keys({over, over}, {}).error().message.find("note 62"), std::string::npos);
}

// The bar is tuned to C6, and a struck wine glass sings with its lowest mode of the rim.
TEST_F(InstrumentTest, BanksOfManyModesHaveTheirTonesAtThePitchOfTheKey) {
  for (const auto& [name, own_hz] : {std::pair{"glockenspiel-bar", 1046.5}, {"wine-glass", 1136.2}}) {
    instrument_.set_file(std::string(RINGDOWN_SOURCE_DIR "/presets/banks/") + name + ".glb");
    play(kControl, 120, 0);
    hear(1024);
    set(Parameter::tuning, 0);
    settle();
    play(kOn, 69, 127);
    const Samples in_tune = hear(24000);
    play(kControl, 120, 0);
    hear(1024);
    set(Parameter::tuning, 1);
    set(Parameter::root_key, 69);
    set(Parameter::size, own_hz / 440);
    settle();
    play(kOn, 69, 127);
    EXPECT_LT(
        test::relative_error_db(test::spectrum(in_tune, kRate).magnitude, test::spectrum(hear(24000), kRate).magnitude),
        -25)
        << name;
    set(Parameter::size, 1);
  }
}

TEST_F(InstrumentTest, MaterialDoesNotMoveConcertPitchButSizeDoes) {
  set(Parameter::stiffness, 3);
  set(Parameter::density, 0.5);
  set(Parameter::size, 2);
  settle();
  play(kOn, 69, 100);
  EXPECT_NEAR(pitch_hz() / 220, 1, 1e-4);
}

TEST_F(InstrumentTest, OwnPitchIsTheObjectsAtTheRootKey) {
  set(Parameter::tuning, 1);
  set(Parameter::root_key, 50);
  settle();
  play(kOn, 62, 100);
  EXPECT_NEAR(pitch_hz() / 2000, 1, 1e-4);
  set(Parameter::stiffness, 4);
  play(kControl, 120, 0);
  settle();
  hear(1024);
  play(kOn, 50, 100);
  EXPECT_NEAR(pitch_hz() / 2000, 1, 1e-4) << "four times as stiff is an octave higher";
}

TEST_F(InstrumentTest, ABendMovesWhatRingsOnItsChannelOnly) {
  set(Parameter::bend_range, 12);
  play(kOn | 1, 69, 100);
  hear(480);
  play(kBend | 2, 0, 127);
  hear(480);
  settle();
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4) << "another channel";
  play(kBend | 1, 127, 127);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / 880, 1, 1e-4);
  play(kBend | 1, 0, 128);  // as DPF's VST3 writes a full bend
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / 880, 1, 1e-4);
  play(kBend | 1, 0, 64);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / 440, 1, 1e-4);
}

TEST_F(InstrumentTest, WithMpeTheFirstChannelBendsAllKeysByTwoSemitones) {
  set(Parameter::mpe, 1);
  set(Parameter::bend_range, 48);
  play(kOn | 3, 69, 100);
  hear(480);
  play(kBend, 127, 127);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(2 / 12.0)), 1, 1e-4);
}

// Sets a registered parameter of a channel.
void set_registered(const std::function<void(std::uint8_t, std::uint8_t)>& control, std::uint8_t number,
                    std::uint8_t value) {
  control(101, 0);
  control(100, number);
  control(6, value);
}

TEST_F(InstrumentTest, MpesConfigurationMessageMakesZones) {
  const auto on = [&](std::uint8_t channel) {
    return [this, channel](std::uint8_t number, std::uint8_t value) {
      play(static_cast<std::uint8_t>(kControl | channel), number, value);
    };
  };
  // What the key of channel 3 has become, in semitones.
  const auto bent = [&] {
    hear(480);
    settle();
    play(kOn | 2, 69, 100);
    hear(480);
    return 12 * std::log2(pitch_hz() / 440);
  };
  set_registered(on(0), 6, 7);   // channels 2 to 8
  set_registered(on(15), 6, 3);  // channels 13 to 15
  play(kOn | 2, 69, 100);
  play(kBend | 2, 0, 80);  // a quarter
  EXPECT_NEAR(bent(), 12, 0.02) << "of 48 semitones";
  play(kBend | 15, 127, 127);
  EXPECT_NEAR(bent(), 12, 0.02) << "the master of the other zone";
  play(kBend, 127, 127);
  EXPECT_NEAR(bent(), 14, 0.02) << "two semitones by the master";
  set_registered(on(3), 0, 24);  // states it for the zone
  play(kBend, 0, 64);
  EXPECT_NEAR(bent(), 6, 0.02) << "a quarter of 24 semitones";
  set_registered(on(0), 6, 0);  // ends the zone
  play(kBend | 2, 127, 127);
  EXPECT_NEAR(bent(), 2, 0.02) << "the parameter Bend range";
  play(kBend, 127, 127);
  EXPECT_NEAR(bent(), 2, 0.02) << "another channel";
  play(kControl | 2, 100, 0);  // either half of the number may come first
  play(kControl | 2, 101, 0);
  play(kControl | 2, 6, 7);
  play(kBend | 2, 127, 127);
  EXPECT_NEAR(bent(), 7, 0.02);
}

TEST_F(InstrumentTest, ASingleKeyIsTunedByTheClapEntrysMessages) {
  const int code = tuning_code(-7.5);
  play(kOn, 69, 100);
  play(kTuneKeyHigh, 69, static_cast<std::uint8_t>(code >> 7));
  play(kTuneKeyLow, 69, static_cast<std::uint8_t>(code & 127));
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / (440 * std::exp2(-7.5 / 12)), 1, 5e-4);
  EXPECT_NEAR(tuning_of(tuning_code(0)), 0, 0);
  EXPECT_EQ(tuning_code(1000), 16383);
}

TEST_F(InstrumentTest, HalfTheVelocityIsAQuarterOfTheImpulse) {
  set(Parameter::contact_time, 0.02);
  play(kOn, 60, 127);
  const double loud = loudness();
  play(kControl, 120, 0);
  hear(1024);
  play(kOn, 60, 64);
  EXPECT_NEAR(loudness() / loud, std::pow(64.0 / 127, 2), 1e-3);
}

// The spectrum of a half sine that lasts tau, at frequency f, over that of an ideal impulse.
double half_sine(double tau_s, double frequency_hz) {
  return std::abs(std::cos(M_PI * frequency_hz * tau_s) / (1 - std::pow(2 * frequency_hz * tau_s, 2)));
}

TEST_F(InstrumentTest, BlowsAreAsSoftAsContactTimeAndController74Say) {
  set(Parameter::contact_time, 0.02);
  play(kOn, 81, 127);  // 880 Hz
  const double hard = loudness(2400);
  for (const auto& [time_ms, control, tau_s] : {std::tuple{1.0, 64, 1e-3}, {1.0, 1, 8e-3}, {4.0, 127, 0.5e-3}}) {
    play(kControl, 120, 0);
    hear(1024);
    set(Parameter::contact_time, time_ms);
    play(kControl, 74, static_cast<std::uint8_t>(control));
    play(kOn, 81, 127);
    EXPECT_NEAR(loudness(2400) / hard, half_sine(tau_s, 880), 0.02) << time_ms << " " << control;
  }
}

TEST_F(InstrumentTest, EvenLoudnessIsTheSameForEveryKey) {
  set(Parameter::contact_time, 0.02);
  std::vector<double> levels;
  for (const std::uint8_t key : {45, 60, 75}) {
    play(kControl, 120, 0);
    hear(1024);
    play(kOn, key, 127);
    levels.push_back(loudness(2400));
  }
  // 2 Pa rms of 20 Pa full scale; a pan of 0 leaves each side 3 dB less.
  EXPECT_NEAR(levels[0], 0.1, 3e-3);
  EXPECT_NEAR(levels[1], levels[0], 1e-3);
  EXPECT_NEAR(levels[2], levels[0], 1e-3);
}

TEST_F(InstrumentTest, AReleasedKeyIsDampedUnlessItRingsOn) {
  set(Parameter::release, 0.1);
  play(kOn, 60, 127);
  const double loud = loudness();
  play(kOff, 60, 0);
  hear(2400);
  EXPECT_NEAR(loudness(96) / loud, 0.5, 0.06) << "half way through the damping";
  hear(2400);
  EXPECT_EQ(loudness(), 0);
  set(Parameter::release, 30);
  play(kOn, 60, 127);
  play(kOff, 60, 0);
  hear(9600);
  EXPECT_GT(loudness(), 0.8 * loud);
}

TEST_F(InstrumentTest, TheSustainPedalKeepsReleasedKeysAndTheDampPedalIsAHandOnEverything) {
  set(Parameter::release, 0.02);
  play(kControl, kSustain, 127);
  play(kOn, 60, 127);
  play(kOff, 60, 0);
  hear(4800);
  EXPECT_GT(loudness(), 0.01);
  play(kControl, kSustain, 0);
  hear(1200);
  EXPECT_EQ(loudness(), 0);
  play(kOn, 60, 127);
  play(kControl, kDamp, 127);
  hear(9600);
  EXPECT_EQ(loudness(), 0);
}

TEST_F(InstrumentTest, SostenutoKeepsTheKeysThatWereDownWhenItWentDown) {
  set(Parameter::release, 0.02);
  play(kOn, 60, 127);
  play(kControl, kSostenuto, 127);
  play(kOff, 60, 0);
  hear(4800);
  EXPECT_GT(loudness(), 0.01);
  play(kControl, kSostenuto, 0);
  hear(1200);
  EXPECT_EQ(loudness(), 0);
}

TEST_F(InstrumentTest, ANoteOffOnAnotherChannelReleasesNothing) {
  set(Parameter::release, 0.02);
  play(kOn | 1, 60, 127);
  play(kOff | 2, 60, 0);
  hear(4800);
  EXPECT_GT(loudness(), 0.01);
  play(kOff | 1, 60, 0);
  hear(1200);
  EXPECT_EQ(loudness(), 0);
}

TEST_F(InstrumentTest, ChangesOfModeAndSystemResetEndNotes) {
  set(Parameter::release, 0.02);
  for (const std::uint8_t controller : {123, 124, 125, 126, 127}) {
    play(kOn | 2, 60, 127);
    play(kControl | 3, controller);
    hear(4800);
    EXPECT_GT(loudness(), 0.01) << "another channel";
    play(kControl | 2, controller);
    hear(1200);
    EXPECT_EQ(loudness(), 0) << int{controller};
  }
  set(Parameter::mpe, 1);
  play(kOn | 2, 60, 127);
  play(kControl, 123);
  hear(1200);
  EXPECT_EQ(loudness(), 0) << "channel 1 of MPE speaks for all";
  play(kControl | 5, kSustain, 127);
  play(kOn | 2, 60, 127);
  play(kOff | 2, 60, 0);
  play(0xff, 0);
  hear(4800);
  EXPECT_EQ(loudness(), 0);
  play(kOn | 2, 60, 127);
  play(kOff | 2, 60, 0);
  hear(1200);
  EXPECT_EQ(loudness(), 0) << "the pedal is up";
}

// RP-015 of the MIDI Association: pedals up, bend in the middle, no pressure; controller 74 stays.
TEST_F(InstrumentTest, ResetAllControllersResetsItsChannel) {
  set(Parameter::release, 0.02);
  set(Parameter::bend_range, 12);
  play(kControl | 1, kSustain, 127);
  play(kBend | 1, 127, 127);
  play(kOn | 1, 69, 127);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz() / 880, 1, 1e-4);
  play(kPressure | 1, 127);
  play(kControl | 2, 121);
  hear(480);
  settle();
  hear(480);
  EXPECT_NEAR(pitch_hz(4800) / 880, 1, 1e-3) << "another channel's reset";
  play(kControl | 1, 121);
  play(kOn | 1, 69, 127);
  hear(480);
  settle();
  hear(480);
  const auto tone = test::fit_damped_sinusoid(hear(9600), kRate);
  EXPECT_NEAR(tone.frequency_hz / 440, 1, 1e-4);
  EXPECT_LT(tone.decay_per_s, 5) << "no hand is on it";
  play(kOff | 1, 69, 0);
  hear(1200);
  EXPECT_EQ(loudness(), 0) << "the pedal is up";
}

// The mode's amplitude falls by exp(-decay t); a damper of c [N s/m] adds c |shape|^2 / 2 to the decay.
TEST_F(InstrumentTest, AftertouchIsAHandThatDampsMoreWhenPressedHarder) {
  const auto decay_per_s = [&](std::uint8_t status, std::uint8_t first, std::uint8_t second) {
    play(kControl, 120, 0);
    hear(1024);
    play(kOn, 81, 127);
    play(status, first, second);
    hear(480);
    settle();
    hear(480);
    return test::fit_damped_sinusoid(hear(4800), kRate).decay_per_s;
  };
  set(Parameter::hand, 10);
  const double free = decay_per_s(kKeyPressure, 81, 0), touched = decay_per_s(kKeyPressure, 81, 64),
               held = decay_per_s(kKeyPressure, 81, 127), channel = decay_per_s(kPressure, 127, 0),
               another = decay_per_s(kPressure | 5, 127, 0);
  EXPECT_NEAR((touched - free) / (held - free), std::pow(64.0 / 127, 2), 1e-2);
  EXPECT_GT(held, free + 1);
  EXPECT_NEAR(channel, held, 1e-3 * held);
  EXPECT_NEAR(another, free, 1e-2);
}

TEST_F(InstrumentTest, AGainIsReachedWithoutAStep) {
  set(Parameter::release, 30);
  play(kOn, 48, 127);
  hear(4800);
  const Samples before = hear(480);
  set(Parameter::gain, -60);
  const Samples ramp = hear(960), after = hear(480);
  EXPECT_LT(test::largest_step(ramp, 1, ramp.size()), 1.2 * test::largest_step(before, 1, before.size()));
  EXPECT_NEAR(test::peak(after) / test::peak(before), 1e-3, 1e-4);
}

TEST_F(InstrumentTest, WidthSpreadsTheKeysAndPanMovesThem) {
  const auto balance = [&](std::uint8_t key) {
    play(kControl, 120, 0);
    hear(1024);
    play(kOn, key, 127);
    hear(4800);
    const double left = loudness(2400);
    return left / test::peak(right_);
  };
  EXPECT_NEAR(balance(40), 1, 1e-6);
  set(Parameter::width, 100);
  hear(2400);
  EXPECT_GT(balance(40), 1.2);
  EXPECT_LT(balance(90), 0.8);
  set(Parameter::pan, 100);
  hear(2400);
  EXPECT_LT(balance(90), 1e-3);
}

}  // namespace
}  // namespace ringdown::plugin
