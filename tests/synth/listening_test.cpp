// What a listener hears of objects at their places, against sums of modes one by one in double.
#include "engine/synth/kernels/direction_kernel.h"
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace ringdown::synth::test::listening {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAmplitude = 0.3;  // of every mode, at 1 m, rms over directions

struct Tone {
  double frequency_hz, t60_s;
  int harmonic;  // l^2 + l + m of its only lobe pattern
};

// Modes that a strike of 1 N s along z at vertex 0 gives an amplitude of kAmplitude each.
modal::Bank bank_of(const std::vector<Tone>& tones) {
  modal::Bank bank = single_mode_bank(440, 1);
  const std::size_t points = bank.point_count();
  bank.frequency_hz.clear(), bank.decay_per_s.clear(), bank.shapes.clear(), bank.losses.clear();
  bank.radiation->maps.modes.clear();
  bank.radiation->error_db.clear();
  bank.frequency_error.clear(), bank.shape_error.clear();
  for (const Tone& tone : tones) {
    bank.frequency_hz.push_back(tone.frequency_hz);
    bank.decay_per_s.push_back(std::log(1000.0) / tone.t60_s);
    const double shape = kAmplitude / (kLoudness * 2 * kPi * tone.frequency_hz);
    bank.shapes.insert(bank.shapes.end(), points, {0, 0, static_cast<float>(shape)});
    modal::FarField field = even_field(tone.frequency_hz);
    field.terms[0].harmonic = static_cast<std::uint16_t>(tone.harmonic);
    field.levels.clear();
    bank.radiation->maps.modes.push_back(field);
  }
  return bank;
}

Rotation turn_about_z(double angle) { return Rotation::from_xyzw(0, 0, std::sin(angle / 2), std::cos(angle / 2)); }

Event pose_at(Frame frame, ObjectNumber object, const Pose& pose) {
  return {.frame = frame, .object = object, .verb = verb::Pose{{pose.position_m, pose.rotation}}};
}
Event listener_at(Frame frame, const Pose& pose) {
  return {.frame = frame, .verb = verb::Listener{{pose.position_m, pose.rotation}}};
}

using Path = std::function<Pose(double t)>;

constexpr double kPoseRate_hz = 60;

// Renders while poses of the object come kPoseRate_hz times a second, each 50 ms ahead of its time.
class Flight {
 public:
  explicit Flight(Player& player) : player_(player) {}
  void render(const Path& path, std::size_t frames, std::size_t block = 256) {
    const auto ahead = static_cast<Frame>(0.05 * kRate);
    for (std::size_t done = 0; done < frames;) {
      const std::size_t now = std::min(block, frames - done);
      for (; next_ < static_cast<Frame>(player_.left.size()) + ahead; ++poses_) {
        player_.push(pose_at(next_, 0, path(static_cast<double>(next_) / kRate)));
        next_ = static_cast<Frame>(std::llround((poses_ + 1) * kRate / kPoseRate_hz));
      }
      player_.render(now, block);
      done += now;
    }
  }

 private:
  Player& player_;
  Frame next_ = 0;
  int poses_ = 0;
};

// Renders while poses come as an embedded scene sends them: 500 a second, two of them ahead.
void render_like_a_scene(Player& player, const Path& path, std::size_t frames, std::size_t block) {
  constexpr Frame kEvery = 96;
  for (Frame next = static_cast<Frame>(player.left.size()); player.left.size() < frames; player.render(block, block)) {
    for (; next < static_cast<Frame>(player.left.size() + block) + 2 * kEvery; next += kEvery) {
      player.push(pose_at(next, 0, path(static_cast<double>(next) / kRate)));
    }
  }
}

double error_db(const Samples& heard, const Samples& exact, std::size_t from) {
  return relative_error_db(std::span(heard).subspan(from), std::span(exact).subspan(from));
}

// The oracle: each tone as it is heard on the left and on the right, at the source's own time `age(t)` after the
// strike, with gain `gain(tone, t)` and from where `side(t)` says: -1 left to 1 right.
struct Heard {
  std::function<double(const Tone&, double t)> gain;
  std::function<double(double t)> side = [](double) { return 0.0; };
  std::function<double(double t)> age;
};
std::array<Samples, 2> exact(const std::vector<Tone>& tones, Frame strike, std::size_t frames, const Heard& heard) {
  std::array<Samples, 2> out{Samples(frames, 0.0), Samples(frames, 0.0)};
  for (std::size_t n = static_cast<std::size_t>(strike); n < frames; ++n) {
    const double t = static_cast<double>(n) / kRate;
    const double age = heard.age ? heard.age(t) : t - static_cast<double>(strike) / kRate;
    double sum = 0;
    for (const Tone& tone : tones) {
      sum += kAmplitude * heard.gain(tone, t) * std::exp(-std::log(1000.0) / tone.t60_s * age) *
             std::sin(2 * kPi * tone.frequency_hz * age);
    }
    const double angle = 0.25 * kPi * (1 + heard.side(t));
    out[0][n] = std::cos(angle) * sum;
    out[1][n] = std::sin(angle) * sum;
  }
  return out;
}

double absorption(double frequency_hz) {
  return modal::AirAbsorption(modal::AirConditions{}).nepers_per_m(frequency_hz);
}

// Real spherical harmonics over 1 / sqrt(4 pi), by their formulas.
double lobes(int harmonic, Vec3 d) {
  if (harmonic == 2) return std::sqrt(3.0) * d.z;
  if (harmonic == 3) return std::sqrt(3.0) * d.x;
  if (harmonic == 8) return std::sqrt(15.0) / 2 * (d.x * d.x - d.y * d.y);
  return 1;
}

const std::vector<Tone> kMany = [] {
  std::vector<Tone> tones;
  for (int i = 0; i < 60; ++i) tones.push_back({110 * std::pow(1.085, i), 3, i % 3 == 0 ? 3 : i % 3 == 1 ? 8 : 0});
  return tones;
}();

class Listened : public testing::TestWithParam<bool> {  // whether many modes sound, so that moments are taken
 protected:
  [[nodiscard]] std::vector<Tone> tones(std::vector<Tone> few) const { return GetParam() ? kMany : few; }
};

TEST_P(Listened, StandingObjectsAreHeardByTheirLobesDistanceAirAndSide) {
  const std::vector<Tone> all = tones({{440, 3, 3}, {2500, 2, 8}, {9000, 1, 0}, {700, 0.01, 3}});
  Player player;
  player.install(0, map_of(bank_of(all)));
  const double turn = 0.4;
  player.push(listener_at(0, {{1, 2, 0.5}, turn_about_z(0.3)}));
  player.push(pose_at(0, 0, {{4, 6, 0.5}, turn_about_z(turn)}));
  player.push(vertex_strike_at(100, 0, 0, {0, 0, 1}));
  player.render(9600, 255);
  const double along = std::atan2(-4, -3) - turn;  // towards the listener, in the object's frame
  const Vec3 d{std::cos(along), std::sin(along), 0};
  const double side = -std::sin(std::atan2(4, 3) - 0.3);
  const auto want =
      exact(all, 100, 9600,
            {.gain = [&](const Tone& tone,
                         double) { return lobes(tone.harmonic, d) / 5 * std::exp(-5 * absorption(tone.frequency_hz)); },
             .side = [&](double) { return side; }});
  EXPECT_LT(error_db(player.left, want[0], 0), -110);
  EXPECT_LT(error_db(player.right, want[1], 0), -110);
}

TEST_P(Listened, AForksLobesPassTheEarAsItTurns) {
  const std::vector<Tone> all = tones({{440, 5, 8}, {2490, 5, 3}});
  Player player;
  player.install(0, map_of(bank_of(all)));
  player.push(listener_at(0, {}));
  player.push(vertex_strike_at(4800, 0, 0, {0, 0, 1}));
  const double spin = 2 * kPi * 0.7;
  Flight(player).render([&](double t) { return Pose{{0.5, 0, 0}, turn_about_z(spin * t)}; }, 38400);
  const auto gain = [&](const Tone& tone, double t) {
    return lobes(tone.harmonic, {-std::cos(spin * t), std::sin(spin * t), 0}) *
           std::exp(-absorption(tone.frequency_hz));
  };
  const auto want = exact(all, 4800, 38400, {.gain = gain});
  EXPECT_LT(error_db(player.left, want[0], 4800), -60);
  EXPECT_LT(error_db(player.right, want[1], 4800), -60);
}

// What only turns is followed more cheaply than what moves: the two agree where the way is too short to be heard.
TEST(Listening, WhatTurnsInPlaceIsHeardAsWhatTremblesMeanwhile) {
  const Map map = map_of(bank_of({{440, 3, 8}, {1200, 3, 3}, {2900, 3, 2}}));
  const auto heard = [&](double way_m, std::size_t block) {
    const auto path = [way_m](double t) {
      const double angle = 3 * (std::min(t, 0.3) + std::max(t - 0.5, 0.0));  // and rests in between
      return Pose{{way_m * std::sin(900 * t), 0, 0}, turn_about_z(angle)};
    };
    Player player;
    player.install(0, map);
    player.push(listener_at(0, {{1, 0.5, 0}, turn_about_z(kPi)}));
    player.push(vertex_strike_at(2000, 0, 0, {0, 0, 1}));
    Flight flight(player);
    flight.render(path, 9000, block);
    player.install(0, map, Mixer::Install::retune, {.stiffness = 1.01});
    flight.render(path, 24600, block);
    return player.left;
  };
  for (const std::size_t block : {128u, 93u}) {
    EXPECT_LT(relative_error_db(heard(0, block), heard(1e-8, block)), -90) << block;
  }
}

// What is silent is not followed: the poses of a second wait when it is struck.
TEST(Listening, AForkThatHasTurnedInSilenceIsHeardFromTheSideThatItHasTurnedTo) {
  const std::vector<Tone> tones = {{440, 3, 8}, {1200, 3, 8}};
  const auto path = [](double t) { return Pose{{0, 0, 0}, turn_about_z(2 * kPi * t)}; };
  constexpr Frame kStrike = 48100;
  constexpr std::size_t kFrames = 57600;
  const auto want = exact(
      tones, kStrike, kFrames, {.gain = [&](const Tone& tone, double t) {
        const double along = -2 * kPi * t;
        return lobes(tone.harmonic, {std::cos(along), std::sin(along), 0}) * std::exp(-absorption(tone.frequency_hz));
      }});
  for (const std::size_t block : {64u, 93u, 256u, 8192u}) {
    Player player;
    player.install(0, map_of(bank_of(tones)));
    player.push(listener_at(0, {{1, 0, 0}, turn_about_z(kPi)}));
    player.push(vertex_strike_at(kStrike, 0, 0, {0, 0, 1}));
    render_like_a_scene(player, path, kFrames, block);
    const auto n = static_cast<std::size_t>(std::min<Frame>(static_cast<Frame>(player.left.size()), kFrames));
    const std::span<const double> heard(player.left.data(), n), exactly(want[0].data(), n);
    EXPECT_LT(relative_error_db(heard, exactly), -60) << "blocks of " << block;
  }
}

TEST_P(Listened, APassingRodIsHeardHigherAndThenLower) {
  const std::vector<Tone> all = tones({{440, 5, 0}, {1490, 5, 0}, {6000, 5, 0}});
  Player player;
  player.install(0, map_of(bank_of(all)));
  player.push(listener_at(0, {}));
  player.push(vertex_strike_at(4800, 0, 0, {0, 0, 1}));
  const double speed = 20, c = 343.2, aside = 3, begin = -8;
  const auto place = [&](double t) { return Vec3{begin + speed * t, aside, 0}; };
  Flight(player).render([&](double t) { return Pose{place(t), {}}; }, 38400);
  // The source's time, by Simpson's rule.
  const auto rate = [&](double t) { return 1 / (1 + speed * place(t).x / length(place(t)) / c); };
  std::vector<double> ages(38401, 0.0);
  for (std::size_t n = 4800; n < 38400; ++n) {
    const double t = static_cast<double>(n) / kRate, h = 1 / kRate;
    ages[n + 1] = ages[n] + h / 6 * (rate(t) + 4 * rate(t + h / 2) + rate(t + h));
  }
  const auto gain = [&](const Tone& tone, double t) {
    return std::exp(-absorption(tone.frequency_hz) * length(place(t))) / length(place(t));
  };
  const auto want = exact(all, 4800, 38400,
                          {.gain =
                               [&](const Tone& tone, double t) {
                                 return tone.harmonic == 0
                                            ? gain(tone, t)
                                            : gain(tone, t) * lobes(tone.harmonic, (-1 / length(place(t))) * place(t));
                               },
                           .side = [&](double t) { return -place(t).y / length(place(t)); },
                           .age = [&](double t) { return ages[static_cast<std::size_t>(std::llround(t * kRate))]; }});
  EXPECT_LT(error_db(player.left, want[0], 4800), -60);
  EXPECT_LT(error_db(player.right, want[1], 4800), -60);
}

// What Doppler shift leaves behind when poses come 60 times a second: the spectrum of a tone that circles at a steady
// distance has no lines beside it.
TEST(Listening, ACirclingToneHasNoSidebands) {
  Player player;
  player.install(0, map_of(bank_of({{3000, 600, 0}})));
  player.push(listener_at(0, {}));
  player.push(vertex_strike_at(9600, 0, 0, {0, 0, 1}));
  const double spin = 3;  // 6 m/s
  Flight(player).render([&](double t) { return Pose{{2 * std::cos(spin * t), 2 * std::sin(spin * t), 0}, {}}; }, 48000);
  // Both channels together are as loud all the time, so their squares add up to a tone's.
  double power = 0;
  std::vector<std::complex<double>> values;
  constexpr std::size_t kCount = 32768;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double t = static_cast<double>(n + 12000) / kRate;
    const double angle = 0.25 * kPi * (1 - std::sin(spin * t));
    const double mono = std::cos(angle) * player.left[n + 12000] + std::sin(angle) * player.right[n + 12000];
    const double window = 0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(n) / kCount);
    values.emplace_back(window * window * mono, 0);
    power = std::max(power, std::abs(mono));
  }
  const auto spectrum = fourier(values);
  double line = 0, beside = 0;
  for (std::size_t k = 0; k < kCount / 2; ++k) {
    const double hz = static_cast<double>(k) * kRate / kCount;
    double& largest = std::abs(hz - 3000) < 12 ? line : beside;
    largest = std::max(largest, std::abs(spectrum[k]));
  }
  EXPECT_LT(20 * std::log10(beside / line), -60);
  EXPECT_GT(line, 0);
}

// A player of 60 modes that ring, heard from 2 m away.
std::unique_ptr<Player> ringing() {
  auto player = std::make_unique<Player>();
  player->install(0, map_of(bank_of(kMany)));
  player->push(listener_at(0, {}));
  player->push(pose_at(0, 0, {{2, 0, 0}, {}}));
  player->push(vertex_strike_at(0, 0, 0, {0, 0, 0.05}));
  player->render(4800);
  return player;
}

double largest_of(const Player& player) {
  double largest = 0;
  for (const Samples* side : {&player.left, &player.right}) {
    for (const double x : *side) largest = std::max(largest, std::isfinite(x) ? std::abs(x) : 1e9);
  }
  return largest;
}

TEST(Listening, WhateverMovesHoweverIsFiniteAndBounded) {
  std::mt19937 random(3);
  const auto uniform = [&random](double size) { return size * (static_cast<double>(random()) / 2147483648.0 - 1); };
  auto player = ringing();
  for (int i = 0; i < 300; ++i) {
    const double size = std::pow(10, uniform(6));  // micrometres to a thousand kilometres
    const Pose pose{{uniform(size), uniform(size), uniform(size)},
                    normalized(Rotation::from_xyzw(uniform(1), uniform(1), uniform(1), uniform(1) + 1e-3))};
    const auto now = static_cast<Frame>(player->left.size());
    player->push(i % 3 == 0 ? listener_at(now + i, pose) : pose_at(now + 2 * i, 0, pose));
    if (i % 7 == 0) player->push(vertex_strike_at(now + 70, 0, 0, {0, 0, 0.05}));
    player->render(130, 130);
  }
  EXPECT_LT(largest_of(*player), 100 * 0.05 * 60);  // as many strikes, none louder than its modes at their lobes
  EXPECT_EQ(player->mixer.counters().not_finite, 0u);
}

// With many modes looks may add up 0.3 terms for each.
TEST(Listening, LooksThatWouldCostTooMuchComeRarerByAsMuchAndSteadily) {
  LookPressure pressure;
  Chunk chunk;
  const auto chunks = [&](double terms, std::size_t frames) {
    for (chunk.frames = frames; chunk.begin < 300 * static_cast<Frame>(kChunkFrames); chunk.begin = chunk.end()) {
      pressure.update(terms, 10000, chunk);
    }
    chunk.begin = 0;
    return pressure.now();
  };
  EXPECT_NEAR(chunks(30000, kChunkFrames), 10, 1e-3);
  EXPECT_NEAR(chunks(15000, kChunkFrames / 2), 10, 1e-3);
  EXPECT_EQ(chunks(2000, kChunkFrames), 1);
}

TEST(Listening, PosesThatAreNoNumbersAreRefusedAndChangeNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  auto player = ringing(), undisturbed = ringing();
  const std::array<Pose, 5> poses = {Pose{{kNan, 0, 0}, {}}, Pose{{0, kInf, 0}, {}},
                                     Pose{{0, 0, 0}, Rotation::from_xyzw(0, 0, 0, 0)},
                                     Pose{{0, 0, 0}, Rotation::from_xyzw(kNan, 0, 0, 1)}, Pose{{0, 0, 1e300}, {}}};
  for (const Pose& pose : poses) {
    player->push(pose_at(4800, 0, pose));
    player->push(listener_at(4800, pose));
  }
  player->push({.frame = 4800, .verb = verb::ListenerAir{kNan, 0}});
  player->render(4800);
  undisturbed->render(4800);
  EXPECT_EQ(player->mixer.counters().refused, 11u);
  EXPECT_EQ(player->left, undisturbed->left);
}

TEST(Listening, AListenerInsideABodyHearsItAllAroundNoLouderThanAtItsOwnLevel) {
  auto player = ringing();
  player->push(listener_at(4800, {{2, 0, 0}, {}}));
  player->render(9600);
  EXPECT_LT(largest_of(*player), 2 * 0.05 * kAmplitude * 60);
  for (std::size_t n = 9600; n < 14400; ++n) ASSERT_NEAR(player->left[n], player->right[n], 1e-6);
}

TEST(Listening, AJumpIsHeardAsAQuickChangeWithoutAClick) {
  Player player;
  player.install(0, map_of(bank_of({{300, 60, 3}})));
  player.push(listener_at(0, {}));
  player.push(pose_at(0, 0, {{1, 0, 0}, {}}));
  player.push(vertex_strike_at(0, 0, 0, {0, 0, 1}));
  player.render(4800);
  player.push(pose_at(4800, 0, {{0, 900, 0}, turn_about_z(2)}));
  player.render(9600);
  const double step = largest_step(player.left, 1000, 4000);
  EXPECT_LT(largest_step(player.left, 4700, 9000), 1.1 * step);
  EXPECT_LT(peak(std::span(player.left).subspan(9000)), 0.01);
}

TEST(Listening, WithoutAListenerPosesChangeNothingAndWhenTheyLeaveAllIsAsBefore) {
  const auto play = [](bool listens, bool posed) {
    auto player = std::make_unique<Player>();
    player->install(0, map_of(bank_of(kMany)));
    if (posed) player->push(pose_at(0, 0, {{3, 4, 0}, turn_about_z(1)}));
    player->push(pan_at(0, 0, -0.5));
    player->push(vertex_strike_at(500, 0, 0, {0, 0, 1}));
    player->render(1000);
    if (listens) player->push(listener_at(1000, {}));
    player->render(4000);
    if (listens) player->push({.frame = 5000, .verb = verb::ListenerOff{}});
    player->render(7000);
    return player;
  };
  const auto plain = play(false, false), posed = play(false, true), heard = play(true, true);
  EXPECT_EQ(plain->left, posed->left);
  EXPECT_NE(plain->left, heard->left);
  for (std::size_t n = 8000; n < 12000; ++n) ASSERT_NEAR(plain->left[n], heard->left[n], 3e-6) << n;
}

TEST(Listening, GainsOfManyModesAreTheirFarFieldsOverTheirRmsButForAPhaseOfEachMode) {
  std::mt19937 random(9);
  const auto uniform = [&random] { return static_cast<float>(random()) / 2147483648.0F - 1; };
  modal::RadiationMaps maps;
  std::vector<std::uint32_t> order;
  for (std::uint32_t m = 0; m < 21; ++m) {
    modal::FarField field;
    for (std::uint16_t h = 0; h < modal::harmonic_count(9); ++h) {
      if (random() % 3 == 0) field.terms.push_back({h, {uniform(), uniform()}});
    }
    maps.modes.push_back(field);
    order.push_back(20 - m);
  }
  const modal::DirectionMap map(maps, order);
  std::vector<std::complex<double>> turned(21);
  for (int i = 0; i < 10; ++i) {
    const Vec3 toward{uniform(), uniform(), uniform()};
    std::vector<float> harmonics(modal::harmonic_count(9)), re(24), im(24);
    modal::real_harmonics(toward, 9, harmonics);
    look_up(map, harmonics.data(), re.data(), im.data());
    for (std::size_t rank = 0; rank < 21; ++rank) {
      const modal::FarField& field = maps.modes[order[rank]];
      const std::complex<double> exact =
          std::conj(std::complex<double>(modal::far_field(field, harmonics))) / rms(field);
      const std::complex<double> phase = std::complex<double>(re[rank], im[rank]) / exact;
      if (i == 0) turned[rank] = phase;
      EXPECT_NEAR(std::abs(phase), 1, 1e-5);
      EXPECT_NEAR(std::abs(phase - turned[rank]), 0, 1e-4 + 1e-5 / std::abs(exact));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(FewAndMany, Listened, testing::Bool(),
                         [](const auto& many) { return many.param ? std::string("Many") : std::string("Few"); });

}  // namespace
}  // namespace ringdown::synth::test::listening
