#include "tests/plugin/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace ringdown::test {
namespace {

constexpr std::uint32_t kBlock = 256;
constexpr double kContact_s = 2e-4, kBlow_m_s = 0.1;
constexpr int kBow = 6, kHighVelocity = 100;
constexpr std::size_t kObject = 1, kTuning = 2, kRootKey = 3, kEven = 10, kWidth = 13, kRelease = 14, kMallet = 20;

// The table of docs/use/plugin.md, from yarn to brass.
struct Mallet {
  double mass_kg, head, bounce;
};
constexpr std::array<Mallet, 5> kMallets = {
    {{0.03, 3e5, 0.5}, {0.03, 2e6, 0.6}, {0.016, 1e7, 0.75}, {0.01, 1e9, 0.7}, {0.036, 1e10, 0.85}}};

void scale(const std::array<double, 3>& vector, double factor, double (&scaled)[3]) {
  for (std::size_t axis = 0; axis < 3; ++axis) scaled[axis] = factor * vector[axis];
}

}  // namespace

Score random_notes(int count, std::uint32_t frames, unsigned seed) {
  std::mt19937 random(seed);
  Score score{{}, frames};
  for (int i = 0; i < count; ++i) {
    const auto key = static_cast<std::uint8_t>(55 + random() % 30),
               velocity = static_cast<std::uint8_t>(1 + random() % 127);
    score.events.push_back({static_cast<std::uint32_t>(random() % (frames * 3 / 4)), {0x90, key, velocity}});
  }
  std::sort(score.events.begin(), score.events.end());
  return score;
}

Sound play(PluginHost& host, const Score& score, const std::vector<std::uint32_t>& blocks) {
  Sound sound{std::vector<float>(score.frames), std::vector<float>(score.frames)};
  std::size_t turn = 0, next = 0;
  for (std::uint32_t at = 0; at < score.frames;) {
    const std::uint32_t frames = std::min(blocks[turn++ % blocks.size()], score.frames - at);
    std::vector<MidiEvent> events;
    for (; next < score.events.size() && score.events[next].first < at + frames; ++next) {
      events.push_back({score.events[next].first - at, score.events[next].second});
    }
    host.render(events, sound.left.data() + at, sound.right.data() + at, frames);
    at += frames;
  }
  return sound;
}

double power(const std::vector<float>& samples) {
  double sum = 0;
  for (const float sample : samples) sum += static_cast<double>(sample) * static_cast<double>(sample);
  return sum;
}

double difference_db(const Sound& a, const Sound& b) {
  std::vector<float> left(a.left.size()), right(a.right.size());
  std::transform(a.left.begin(), a.left.end(), b.left.begin(), left.begin(), std::minus<>());
  std::transform(a.right.begin(), a.right.end(), b.right.begin(), right.begin(), std::minus<>());
  return 10 * std::log10((power(left) + power(right) + 1e-30) / (power(a.left) + power(a.right) + 1e-30));
}

LibraryInstrument::LibraryInstrument(const Rig& rig) : rig_(rig) {
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.limiter_db = 1;
  ringdown_mixer_create(&settings, &mixer_, nullptr);
}

LibraryInstrument::~LibraryInstrument() {
  ringdown_mixer_destroy(mixer_);
  for (const auto& [name, opened] : banks_) ringdown_bank_release(opened.bank);
}

LibraryInstrument::Bank LibraryInstrument::open(const std::string& preset) {
  Bank opened;
  const std::string path = RINGDOWN_SOURCE_DIR "/presets/banks/" + preset + ".glb";
  EXPECT_EQ(ringdown_bank_open(path.c_str(), &opened.bank, nullptr), RINGDOWN_OK) << path;
  ringdown_bank_info info{};
  info.size = sizeof info;
  ringdown_bank_describe(opened.bank, &info);
  opened.mass_kg = info.mass_kg;
  const float* const shapes = ringdown_bank_shapes(opened.bank);
  const auto shape = [&](std::size_t mode, std::size_t point, std::size_t axis) {
    return static_cast<double>(shapes[3 * (mode * info.points + point) + axis]);
  };
  double max = -1;
  for (std::size_t point = 0; point < info.points; ++point) {
    double motion = 0;
    for (std::size_t mode = 0; mode < std::min<std::size_t>(8, info.modes); ++mode) {
      for (std::size_t axis = 0; axis < 3; ++axis) motion += std::pow(shape(mode, point, axis), 2);
    }
    if (motion > max) max = motion, opened.vertex = static_cast<std::uint32_t>(point);
  }
  double length = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) length += std::pow(shape(0, opened.vertex, axis), 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    opened.place.direction[axis] = shape(0, opened.vertex, axis) / std::sqrt(length);
    opened.place.point_m[axis] = static_cast<double>(ringdown_bank_points_m(opened.bank)[3 * opened.vertex + axis]);
  }
  double pitch_hz = 0, nearest = 1e9, most = 0;
  ringdown_pitch kind{};
  ringdown_bank_pitch(opened.bank, &pitch_hz, &kind);
  for (std::size_t mode = 0; mode < info.modes; ++mode) {
    double across = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      across += shape(mode, opened.vertex, axis) * opened.place.direction[axis];
    }
    most = std::max(most, across * across);
    const double frequency_hz = ringdown_bank_frequencies_hz(opened.bank)[mode];
    const double away = std::abs(std::log(frequency_hz / pitch_hz));
    if (away >= nearest) continue;
    nearest = away;
    opened.bowed_per_kg = across * across;
    opened.bowed_rad_s = 2 * std::numbers::pi * frequency_hz;
  }
  EXPECT_GT(opened.bowed_per_kg, 0.01 * most) << "the mode of the pitch moves under the bow";
  return opened;
}

double LibraryInstrument::size_of(int key) const { return std::exp2((rig_.root_key - key) / 12.0); }

void LibraryInstrument::give_bank(int key) {
  const std::string name = "key" + std::to_string(key);
  EXPECT_EQ(ringdown_add(mixer_, name.c_str(), banks_.at(rig_.bank).bank, &objects_[key], nullptr), RINGDOWN_OK);
  ringdown_material material;
  ringdown_material_init(&material, sizeof material);
  material.size = size_of(key);
  EXPECT_EQ(ringdown_set_material(mixer_, objects_[key], &material, nullptr), RINGDOWN_OK);
}

void LibraryInstrument::set(const Rig& rig) {
  const bool is_other = rig.bank != rig_.bank;
  rig_ = rig;
  if (!banks_.contains(rig.bank)) banks_[rig.bank] = open(rig.bank);
  if (!is_other) return;
  for (const auto& [key, object] : objects_) give_bank(key);
}

void LibraryInstrument::draw_bow(std::int64_t frame, int key, const Rig::Place& place, double speed_m_s,
                                 double force_n) {
  ringdown_bow_args args;
  ringdown_bow_args_init(&args, sizeof args);
  scale(place.point_m, size_of(key), args.point_m);
  scale(place.direction, 1, args.direction);
  args.speed_m_s = speed_m_s;
  args.force_n = force_n;
  args.number = static_cast<std::uint32_t>(key);
  EXPECT_EQ(ringdown_bow(mixer_, frame, objects_[key], &args, nullptr), RINGDOWN_OK);
}

// A bow's force at a pressure p is p / 2 of omega m v, the greatest with which the hair still slips once in a period,
// times the difference of both frictions. The first pressure is a half.
void LibraryInstrument::press(std::int64_t frame, int key, int velocity) {
  if (!objects_.contains(key)) give_bank(key);
  const Bank& bank = banks_.at(rig_.bank);
  const bool is_second = rig_.second && velocity >= kHighVelocity;
  const Rig::Place& place = is_second ? *rig_.second : bank.place;
  const double size = size_of(key), volume = size * size * size, mass_kg = bank.mass_kg * volume;
  const double full_ns = kBlow_m_s * mass_kg, share = std::pow(velocity / 127.0, 2);
  if (rig_.mallet == 0) {
    double impulse_ns[3], point_m[3];
    scale(place.direction, share * full_ns, impulse_ns);
    scale(place.point_m, size, point_m);
    const double contact_s = std::min(0.1, kContact_s * std::pow(share, -0.2));
    const auto struck =
        is_second ? ringdown_strike(mixer_, frame, objects_[key], point_m, impulse_ns, contact_s, nullptr)
                  : ringdown_strike_vertex(mixer_, frame, objects_[key], bank.vertex, impulse_ns, contact_s, nullptr);
    EXPECT_EQ(struck, RINGDOWN_OK);
  } else if (rig_.mallet == kBow) {
    const double hair_m_s = 0.2, suits_n = 0.5 * bank.bowed_rad_s / size * hair_m_s / (bank.bowed_per_kg / volume);
    const double speed_m_s = hair_m_s * velocity / 127.0;
    draw_bow(frame, key, place, speed_m_s, suits_n / 2);
    lifts_[key] = [=, this](std::int64_t then) { draw_bow(then, key, place, speed_m_s, 0); };
  } else {
    const Mallet& mallet = kMallets[static_cast<std::size_t>(rig_.mallet) - 1];
    ringdown_mallet_args args;
    ringdown_mallet_args_init(&args, sizeof args);
    args.head = mallet.head;
    args.bounce = mallet.bounce;
    args.mass_kg = std::max(mallet.mass_kg, full_ns / (5 * (1 + mallet.bounce)));  // 5 m/s at full velocity
    scale(place.point_m, size, args.point_m);
    scale(place.direction, share * full_ns / (1 + mallet.bounce) * (1 / args.mass_kg + 1 / mass_kg), args.velocity_m_s);
    EXPECT_EQ(ringdown_mallet(mixer_, frame, objects_[key], &args, nullptr), RINGDOWN_OK);
  }
}

Sound LibraryInstrument::play(const Score& score) {
  set(rig_);
  Sound sound{std::vector<float>(score.frames), std::vector<float>(score.frames)};
  const std::int64_t begin = ringdown_now(mixer_);
  std::size_t next = 0;
  for (std::uint32_t at = 0; at < score.frames;) {
    const std::uint32_t frames = std::min(kBlock, score.frames - at);
    for (; next < score.events.size() && score.events[next].first < at + frames; ++next) {
      const auto& [frame, midi] = score.events[next];
      if (midi[0] == 0x90) press(begin + frame, midi[1], midi[2]);
      if (midi[0] != 0x80 || !lifts_.contains(midi[1])) continue;
      lifts_.at(midi[1])(begin + frame);
      lifts_.erase(midi[1]);
    }
    ringdown_render(mixer_, sound.left.data() + at, sound.right.data() + at, frames);
    at += frames;
    ringdown_status status{};
    status.size = sizeof status;
    ringdown_get_status(mixer_, &status);
    sound.max_modes = std::max(sound.max_modes, status.ringing_modes);
  }
  return sound;
}

void set_plain(PluginHost& host) {
  for (const auto& [number, value] :
       std::map<std::size_t, double>{{kTuning, 1}, {kEven, 0}, {kWidth, 0}, {kRelease, kRingsOn}}) {
    host.set_parameter(number, value);
  }
}

namespace {

// A parameter reaches the plug-in with a block. Then its worker loads an object whenever it gets the processor, or at
// once where a session is loaded: of the present state, so that nothing else changes.
void set(PluginHost& host, const Rig& rig, const std::function<Sound(const Score&)>& play_on_both) {
  host.set_parameter(kObject, rig.object);
  host.set_parameter(kRootKey, rig.root_key);
  host.set_parameter(kMallet, rig.mallet);
  for (int turn = 0; turn < 3; ++turn) {
    play_on_both({{}, kBlock});
    EXPECT_TRUE(host.load(host.save()));
  }
}

// Strokes of the bow end; some notes meet what rings.
Score score_for(const Rig& rig, unsigned seed) {
  if (rig.mallet != kBow) return random_notes(24, 48 * kBlock, seed);
  Score score{{}, 64 * kBlock};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const auto key = static_cast<std::uint8_t>(60 + 4 * i), velocity = static_cast<std::uint8_t>(60 + 15 * i);
    score.events.push_back({100 + 2000 * i, {0x90, key, velocity}});
    score.events.push_back({6000 + 2000 * i, {0x80, key, 0}});
  }
  std::sort(score.events.begin(), score.events.end());
  return score;
}

}  // namespace

double largest_difference_db(PluginHost& host, const std::vector<Rig>& rigs,
                             const std::function<void()>& after_blocks) {
  LibraryInstrument library(rigs.front());
  double largest = -1000;
  const auto play_on_both = [&](const Score& score) {
    const Sound expected = library.play(score), heard = play(host, score, {kBlock});
    after_blocks();
    const bool is_loud = power(expected.left) > 1e-9;
    EXPECT_TRUE(is_loud || score.events.empty());
    if (is_loud) largest = std::max(largest, difference_db(expected, heard));
    return expected;
  };
  for (unsigned i = 0; i < rigs.size(); ++i) {
    set(host, rigs[i], play_on_both);
    library.set(rigs[i]);
    play_on_both(score_for(rigs[i], i));
  }
  return largest;
}

}  // namespace ringdown::test
