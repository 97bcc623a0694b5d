// The mallets and the bow of the parameter "Mallet". That they sound as libringdown's do, plugin_test.cpp tests.
#include "tests/plugin/instrument_fixture.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace ringdown::plugin {
namespace {

constexpr double kYarn = 1, kRubber = 3, kBow = 6;
constexpr std::uint8_t kBreath = 2, kExpression = 11;
constexpr std::size_t kBlock = 256;

struct Note {
  std::size_t block;
  std::uint8_t key, velocity;
};
constexpr std::size_t kBlocks = 24;

class Mallets : public InstrumentTest {
 protected:
  void play_preset(const std::string& name) {
    instrument_.set_file(preset(name));
    set(Parameter::tuning, 1);
    set(Parameter::even_loudness, 0);
    set(Parameter::release, 30);
    settle();
    silence();
  }
  static std::string preset(const std::string& name) {
    return std::string(RINGDOWN_SOURCE_DIR "/presets/banks/") + name + ".glb";
  }
  void silence() {
    play(kControl, 120, 0);
    hear(2048);
  }
  Samples hear_notes(std::span<const Note> notes) {
    Samples sound;
    for (std::size_t block = 0; block < kBlocks; ++block) {
      for (const Note& note : notes) {
        if (note.block == block) play(kOn, note.key, note.velocity);
      }
      const Samples more = hear(kBlock);
      sound.insert(sound.end(), more.begin(), more.end());
    }
    return sound;
  }
};

// The second blow meets a bar that moves, so the two do not add up as forces that are known in advance do.
TEST_F(Mallets, FeelWhatRings) {
  play_preset("glockenspiel-bar");
  constexpr std::array<Note, 2> kBoth = {{{0, 60, 110}, {4, 60, 110}}};
  const auto sum_error_db = [&](double choice) {
    set(Parameter::mallet, choice);
    std::vector<Samples> sounds;
    const std::span<const Note> both(kBoth);
    for (const auto& notes : {both, both.first(1), both.last(1)}) {
      silence();
      sounds.push_back(hear_notes(notes));
    }
    std::ranges::transform(sounds[1], sounds[2], sounds[1].begin(), std::plus());
    return test::relative_error_db(sounds[0], sounds[1]);
  };
  EXPECT_LT(sum_error_db(0), -100);
  EXPECT_GT(sum_error_db(kRubber), -40);
}

TEST_F(Mallets, StayOnTheObjectIfTheyStrikeWhileTheDampPedalIsDown) {
  set(Parameter::release, 30);
  set(Parameter::hand, 100);
  const auto left = [&](double choice, std::uint8_t pedal) {
    set(Parameter::mallet, choice);
    silence();
    play(kControl, kDamp, pedal);
    play(kOn, 81, 100);
    hear(480);
    settle();
    const double first = loudness();
    hear(9600);
    const double later = loudness() / first;
    play(kOff, 81, 0);
    play(kControl, kDamp, 0);
    hear(480);
    settle();
    return later;
  };
  EXPECT_GT(left(kYarn, 0), 0.9);
  EXPECT_LT(left(kYarn, 127), 0.1);
  EXPECT_GT(left(kYarn, 0), 0.9) << "the hand has left";
  EXPECT_GT(left(0, 127), 0.9) << "as struck";
}

class Bowed : public Mallets {
 protected:
  Bowed() {
    set(Parameter::mallet, kBow);
    set(Parameter::release, 0.05);
  }
  // The peak after the sound has settled.
  double level() {
    hear(9600);
    return loudness(4800);
  }
};

TEST_F(Bowed, KeysSoundAtTheirPitchForAsLongAsTheyAreDown) {
  play(kOn, 69, 127);
  const double first = level();
  EXPECT_GT(first, 0.01);
  hear(96000);
  EXPECT_NEAR(loudness(4800) / first, 1, 0.1);
  EXPECT_NEAR(pitch_hz() / 440, 1, 0.01);
  play(kOff, 69, 0);
  hear(4800);
  EXPECT_EQ(loudness(), 0);
}

// A mode that sticks to the hair for a part of each period moves about as fast as the hair.
TEST_F(Bowed, ThePlaceMovesAboutAsFastAsTheHair) {
  play(kOn, 69, 127);
  const double bowed = level();
  silence();
  set(Parameter::mallet, 0);
  set(Parameter::even_loudness, 0);
  set(Parameter::contact_time, 0.02);
  play(kOn, 69, 127);  // a blow that gives the object, of 1 kg, 0.1 m/s; so does it the mode, of 1 kg
  EXPECT_NEAR(20 * std::log10(bowed / loudness(4800)), 20 * std::log10(0.2 / 0.1), 4);
}

TEST_F(Bowed, BreathExpressionAndController74SetTheSpeed) {
  play(kOn | 1, 69, 127);
  const double full = level();
  for (const std::uint8_t controller : {kBreath, kExpression, std::uint8_t{74}}) {
    play(kControl | 2, controller, 32);
    EXPECT_NEAR(level() / full, 1, 0.1) << "another channel";
    play(kControl | 1, controller, 64);
    EXPECT_NEAR(level() / full, 64 / 127.0, 0.1) << int{controller};
    play(kControl | 1, 121);
    EXPECT_NEAR(level() / full, 1, 0.1) << "reset";
  }
}

TEST_F(Bowed, PressureIsTheForceAndNoHand) {
  play(kOn | 1, 81, 127);
  const double full = level();
  play(kPressure | 1, 0);
  hear(4800);
  settle();
  const auto left = [&] {
    const double first = loudness(4800);
    hear(9600);
    return loudness(4800) / first;
  };
  const double off = left();
  set(Parameter::mallet, 0);
  play(kOn | 2, 81, 100);
  EXPECT_NEAR(off / left(), 1, 0.01) << "neither a bow nor a hand is on it";
  play(kOff | 2, 81);
  set(Parameter::mallet, kBow);
  play(kOn | 1, 81, 127);
  level();
  play(kKeyPressure | 1, 81, 127);
  hear(48000);
  EXPECT_NEAR(level() / full, 1, 0.2);
}

TEST_F(Bowed, AnotherMalletOrAllSoundOffLiftsTheBow) {
  set(Parameter::hand, 100);
  for (const bool is_sound_off : {true, false}) {
    play(kOn, 81, 127);
    EXPECT_GT(level(), 0.01);
    set(Parameter::mallet, kYarn);
    if (is_sound_off) play(kControl, 120);
    if (!is_sound_off) play(kOn, 81, 1);
    hear(9600);
    play(kPressure, 127);  // is a hand now
    hear(960);
    settle();
    hear(48000);
    EXPECT_LT(loudness(), 0.001) << is_sound_off;
    play(kOff, 81);
    set(Parameter::mallet, kBow);
    silence();
    settle();
  }
}

TEST_F(Bowed, AnotherObjectEndsTheBow) {
  play(kOn, 69, 127);
  EXPECT_GT(level(), 0.01);
  instrument_.set_file(preset("glockenspiel-bar"));
  hear(4800);
  play(kControl, kBreath, 100);
  play(kOff, 69, 0);
  hear(9600);
  EXPECT_EQ(loudness(), 0);
}

TEST_F(Bowed, NotesOfAMapAreBowedAsStruckAndStruckByMallets) {
  const std::string map = folder_
                              .write("notes.toml",
                                     "release_s = 0.05\n[[note]]\nnote = 60\nobject = 'mode'\nbow_speed_m_s = 0.3\n"
                                     "bow_force_n = 400\nbow_direction = [0, 0, 2]\n")
                              .string();
  instrument_.set_file(map);
  settle();
  for (const bool is_bowed : {true, false}) {
    set(Parameter::mallet, is_bowed ? 0 : kYarn);
    silence();
    play(kOn, 60, 127);
    const double first = level();
    hear(96000);
    const double later = loudness(4800);
    EXPECT_NEAR(later / first, is_bowed ? 1 : std::exp(-0.5 * 2), 0.1) << is_bowed;
    play(kOff, 60, 0);
  }
}

}  // namespace
}  // namespace ringdown::plugin
