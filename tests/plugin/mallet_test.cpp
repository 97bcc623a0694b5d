// The mallets and the bow of the parameter "Mallet": libringdown's own, by what docs/use/plugin.md says about them.
#include "tests/plugin/instrument_fixture.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace ringdown::plugin {
namespace {

constexpr double kYarn = 1, kRubber = 3, kBow = 6;
constexpr std::uint8_t kBreath = 2, kExpression = 11;
constexpr std::size_t kBlock = 256;

struct Described {
  double choice, mass_kg, head, bounce;
};
constexpr std::array<Described, 5> kDescribed = {
    {{1, 0.03, 3e5, 0.5}, {2, 0.03, 2e6, 0.6}, {3, 0.016, 1e7, 0.75}, {4, 0.01, 1e9, 0.7}, {5, 0.036, 1e10, 0.85}}};

struct Note {
  std::size_t block;
  std::uint8_t key, velocity;
};
constexpr std::array<Note, 5> kNotes = {{{0, 60, 127}, {3, 60, 90}, {4, 48, 100}, {9, 60, 20}, {12, 72, 64}}};
constexpr std::size_t kBlocks = 24;

// The point where the eight leading modes move most, and the direction of the first there.
struct Place {
  double point_m[3], direction[3];
};
Place place_of(const ringdown_bank* bank, const ringdown_bank_info& info) {
  const float* const shapes = ringdown_bank_shapes(bank);
  std::size_t best = 0;
  double max = -1;
  for (std::size_t point = 0; point < info.points; ++point) {
    double motion = 0;
    for (std::size_t mode = 0; mode < std::min<std::size_t>(8, info.modes); ++mode) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        motion += std::pow(static_cast<double>(shapes[3 * (mode * info.points + point) + axis]), 2);
      }
    }
    if (motion > max) max = motion, best = point;
  }
  Place place{};
  double square = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) square += std::pow(static_cast<double>(shapes[3 * best + axis]), 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place.point_m[axis] = static_cast<double>(ringdown_bank_points_m(bank)[3 * best + axis]);
    place.direction[axis] = static_cast<double>(shapes[3 * best + axis]) / std::sqrt(square);
  }
  return place;
}

// The notes on libringdown alone: own pitch at key 60, blows of 0.1 m/s.
Samples by_library(const std::string& path, const Described& mallet) {
  ringdown_bank* bank = nullptr;
  EXPECT_EQ(ringdown_bank_open(path.c_str(), &bank, nullptr), RINGDOWN_OK);
  ringdown_bank_info info{};
  info.size = sizeof info;
  ringdown_bank_describe(bank, &info);
  const Place place = place_of(bank, info);
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.limiter_db = 1;
  ringdown_mixer* mixer = nullptr;
  ringdown_mixer_create(&settings, &mixer, nullptr);
  std::array<std::uint32_t, 128> objects{};
  for (const std::uint8_t key : {48, 60, 72}) {
    ringdown_add(mixer, nullptr, bank, &objects[key], nullptr);
    ringdown_material material;
    ringdown_material_init(&material, sizeof material);
    material.size = std::exp2((60 - key) / 12.0);
    ringdown_set_material(mixer, objects[key], &material, nullptr);
  }
  Samples sound;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    for (const Note& note : kNotes) {
      if (note.block != block) continue;
      const double size = std::exp2((60 - note.key) / 12.0), body_kg = info.mass_kg * size * size * size;
      const double full_ns = 0.1 * body_kg;
      ringdown_mallet_args args;
      ringdown_mallet_args_init(&args, sizeof args);
      args.head = mallet.head;
      args.bounce = mallet.bounce;
      args.mass_kg = std::max(mallet.mass_kg, full_ns / (5 * (1 + mallet.bounce)));  // 5 m/s at full velocity
      const double felt_kg = 1 / (1 / args.mass_kg + 1 / body_kg);
      const double speed = std::pow(note.velocity / 127.0, 2) * full_ns / ((1 + mallet.bounce) * felt_kg);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        args.point_m[axis] = size * place.point_m[axis];
        args.velocity_m_s[axis] = speed * place.direction[axis];
      }
      const std::int64_t now = ringdown_now(mixer);
      EXPECT_EQ(ringdown_mallet(mixer, now, objects[note.key], &args, nullptr), RINGDOWN_OK);
    }
    std::vector<float> left(kBlock), right(kBlock);
    ringdown_render(mixer, left.data(), right.data(), kBlock);
    for (const float sample : left) sound.push_back(static_cast<double>(sample));
  }
  ringdown_mixer_destroy(mixer);
  ringdown_bank_release(bank);
  return sound;
}

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

TEST_F(Mallets, SoundAsTheLibrarysDo) {
  play_preset("glockenspiel-bar");
  for (const Described& mallet : kDescribed) {
    set(Parameter::mallet, mallet.choice);
    silence();
    const Samples expected = by_library(preset("glockenspiel-bar"), mallet);
    EXPECT_GT(test::peak(expected), 1e-4);
    EXPECT_LT(test::relative_error_db(hear_notes(kNotes), expected), -120) << mallet.choice;
  }
}

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
