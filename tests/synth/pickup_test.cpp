// Pickups against a direct sum of mode shapes times modal motion, and what they leave alone.
#include "tests/synth/player.h"

#include <algorithm>
#include <array>
#include <complex>
#include <random>

namespace ringdown::synth::test {
namespace {

constexpr Vec3 kAlong{0.36, -0.48, 0.8};

Vec3 point_of(const modal::Bank& bank, std::size_t point) {
  const auto& p = bank.positions[point];
  return {p[0], p[1], p[2]};
}

Event pickup_at(Frame frame, ObjectNumber object, Vec3 point_m, std::uint32_t motion, std::uint32_t number = 1,
                Vec3 direction = kAlong, double gain = 1) {
  return {frame, object, verb::Pickup{point_m, direction, number, motion, gain}};
}

// A mixer that records its mix and all its pickups.
struct Felt {
  explicit Felt(double rate = kRate) : mixer(rate) {}
  void install(const Map& map, ObjectNumber object = 0, const modal::MaterialScale& material = {},
               Mixer::Install how = Mixer::Install::replace) {
    ASSERT_TRUE(mixer.install(object, voice_of(map, mixer.sample_rate_hz(), material), how));
  }
  void push(const Event& event) { ASSERT_TRUE(mixer.push(Producer::control, event)); }
  void render(std::size_t frames, std::size_t block = 256, const float* input = nullptr) {
    std::vector<std::vector<float>> out(2 + kMaxPickups, std::vector<float>(block));
    for (std::size_t done = 0; done < frames;) {
      const std::size_t now = std::min(block, frames - done);
      Outputs outputs(out[0].data(), out[1].data());
      for (std::size_t p = 0; p < kMaxPickups; ++p) outputs.listen_to_pickup(p, out[2 + p].data());
      mixer.render(outputs, {input ? input + done : nullptr}, now);
      left.insert(left.end(), out[0].begin(), out[0].begin() + static_cast<std::ptrdiff_t>(now));
      for (std::size_t p = 0; p < kMaxPickups; ++p)
        of[p].insert(of[p].end(), out[2 + p].begin(), out[2 + p].begin() + static_cast<std::ptrdiff_t>(now));
      done += now;
    }
  }

  Mixer mixer;
  Samples left;
  std::array<Samples, kMaxPickups> of;
};

// The answer of a place to an impulse of unit modal velocity, `frames` after it: displacement, velocity or
// acceleration.
double answer(double frequency_hz, double decay_per_s, double seconds, std::uint32_t motion) {
  const std::complex<double> s(-decay_per_s, 2 * std::numbers::pi * frequency_hz);
  std::complex<double> z = std::exp(s * seconds) / std::complex<double>(0, s.imag());
  for (std::uint32_t k = 0; k < motion; ++k) z *= s;
  return z.real();
}

double along(const modal::Bank& bank, std::size_t mode, std::size_t point, Vec3 direction) {
  const auto& shape = bank.shape(mode, point);
  return shape[0] * direction.x + shape[1] * direction.y + shape[2] * direction.z;
}

struct Blow {
  Frame frame;
  std::size_t point;
  Vec3 impulse_ns;
};

// The sum over modes and blows, one after the other.
Samples direct_sum(const modal::Bank& bank, std::span<const Blow> blows, std::size_t point, std::uint32_t motion,
                   std::size_t frames, double rate = kRate) {
  Samples sum(frames);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    for (const Blow& blow : blows) {
      const double factor = along(bank, m, point, kAlong) * along(bank, m, blow.point, blow.impulse_ns);
      for (auto n = static_cast<std::size_t>(blow.frame); n < frames; ++n) {
        const double t = static_cast<double>(static_cast<Frame>(n) - blow.frame) / rate;
        sum[n] += factor * answer(bank.frequency_hz[m], bank.decay_per_s[m], t, motion);
      }
    }
  }
  return sum;
}

const std::array<Blow, 3> kBlows{Blow{300, 1, {1, 2, 3}}, Blow{777, 5, {-2, 1, 0.5}}, Blow{1999, 2, {0, 1, -3}}};

// Few modes are rendered by tables, many as moments.
class PickupOf : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(FewAndMany, PickupOf, testing::Values(5, 900));

TEST_P(PickupOf, ABlowFeelsTheSumOfShapesTimesMotion) {
  const modal::Bank bank = random_bank(3, GetParam(), 20);
  for (const std::size_t block : {128, 77, 441}) {
    Felt felt;
    felt.install(map_of(bank));
    for (std::uint32_t motion = 0; motion < 3; ++motion)
      felt.push(pickup_at(0, 0, point_of(bank, 4), motion, motion + 1));
    for (const Blow& blow : kBlows)
      felt.push(vertex_strike_at(blow.frame, 0, static_cast<std::uint32_t>(blow.point), blow.impulse_ns));
    felt.render(4000, block);
    for (std::uint32_t motion = 0; motion < 3; ++motion) {
      const Samples wanted = direct_sum(bank, kBlows, 4, motion, 4000);
      EXPECT_LT(relative_error_db(felt.of[motion], wanted), -105) << "motion " << motion << ", block " << block;
    }
  }
}

TEST_P(PickupOf, AnObjectLeavesTheMixAlone) {
  const modal::Bank bank = random_bank(3, GetParam(), 20);
  const auto play = [&](bool pickup) {
    Felt felt;
    felt.install(map_of(bank));
    if (pickup) felt.push(pickup_at(100, 0, point_of(bank, 4), 1));
    for (const Blow& blow : kBlows)
      felt.push(vertex_strike_at(blow.frame, 0, static_cast<std::uint32_t>(blow.point), blow.impulse_ns));
    felt.push({2500, 0, verb::Choke{0.02}});
    felt.render(4000, 200);
    return felt.left;
  };
  EXPECT_EQ(play(true), play(false));
}

TEST_P(PickupOf, AnObjectBeginsAndEndsInItsFrame) {
  const modal::Bank bank = random_bank(4, GetParam(), 20);
  const auto play = [&](Frame begin, Frame end) {
    Felt felt;
    felt.install(map_of(bank));
    felt.push(vertex_strike_at(0, 0, 1, {1, 2, 3}));
    felt.push(pickup_at(begin, 0, point_of(bank, 4), 1, 3));
    felt.push(pickup_at(end, 0, {}, 1, 3, {}));
    felt.render(2000, 300);
    EXPECT_EQ(felt.mixer.counters().refused, 0u);
    return felt.of[2];
  };
  const Samples whole = play(0, 1999), part = play(501, 1234);
  for (std::size_t n = 0; n < 1999; ++n) {
    ASSERT_NEAR(part[n], n >= 501 && n < 1234 ? whole[n] : 0, 1e-6 * peak(whole)) << n;
  }
  EXPECT_NE(part[501], 0);
  EXPECT_NE(part[1233], 0);
}

// An input pushes sample by sample: the pickup feels the convolution of its samples with the answer to an impulse.
TEST_P(PickupOf, ADrivenObjectFeelsTheConvolution) {
  const modal::Bank bank = random_bank(5, std::min<std::size_t>(GetParam(), 60), 20);
  constexpr std::size_t kFrames = 1200;
  std::vector<float> input(kFrames);
  for (std::size_t n = 100; n < 400; ++n) input[n] = static_cast<float>(std::sin(0.1 * static_cast<double>(n)));
  for (const std::size_t block : {128, 93}) {
    Felt felt;
    felt.install(map_of(bank));
    ASSERT_TRUE(felt.mixer.connect_input(0, 0, point_of(bank, 1), {1, 2, 3}));
    felt.push(pickup_at(0, 0, point_of(bank, 4), 1));
    felt.render(kFrames, block, input.data());
    Samples wanted(kFrames);
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      const double factor = along(bank, m, 4, kAlong) * along(bank, m, 1, {1, 2, 3});
      for (std::size_t n = 0; n < kFrames; ++n) {
        for (std::size_t k = 100; k < std::min<std::size_t>(n, 400); ++k) {
          const double t = static_cast<double>(n - k) / kRate;
          wanted[n] += factor * input[k] * answer(bank.frequency_hz[m], bank.decay_per_s[m], t, 1);
        }
      }
    }
    EXPECT_LT(relative_error_db(felt.of[0], wanted), -100) << block;
  }
}

TEST(Pickup, OfALargerObjectOfAnotherMaterialFollowsMassAndPitch) {
  const modal::Bank bank = single_mode_bank(500, 0, {0, 0, 1});
  const modal::MaterialScale material{.density = 0.8, .stiffness = 1.5, .size = 1.3};
  Felt felt;
  felt.install(map_of(bank), 0, material);
  felt.push(pickup_at(0, 0, {1, 1, 1}, 0, 1, {0, 0, 1}, 1e3));
  felt.push(strike_at(0, 0, {0, 0, 2}));
  felt.render(2000);
  const double f = 500 * std::sqrt(1.5 / 0.8) / 1.3, mass = 0.8 * 1.3 * 1.3 * 1.3;  // modal mass, of 1 as baked
  Samples wanted(2000);
  for (std::size_t n = 0; n < wanted.size(); ++n)
    wanted[n] = 1e3 * 2 / mass * answer(f, 0, static_cast<double>(n) / kRate, 0);
  EXPECT_LT(relative_error_db(felt.of[0], wanted), -100);
}

// Displacement and velocity are found by other gains: central differences of the one are the other, in a bowed bar too.
TEST(Pickup, OfABowedBarMovesAsFastAsItsDisplacementChanges) {
  const Map map = map_of(bar_bank(5));
  Felt felt;
  felt.install(map);
  const Vec3 point_m{0.02, 0, 0};
  for (std::uint32_t motion = 0; motion < 2; ++motion)
    felt.push(pickup_at(0, 0, point_m, motion, motion + 1, {0, 0, 1}));
  felt.push({500, 0, verb::Bow{.point_m = {0, 0, 0}, .direction = {0, 0, 1}, .speed_m_s = 0.2, .force_n = 1}});
  felt.render(8000, 100);
  ASSERT_GT(peak(felt.of[1]), 1e-3);
  Samples slope(7000), velocity(7000);
  for (std::size_t n = 0; n < slope.size(); ++n) {
    slope[n] = (felt.of[0][n + 501] - felt.of[0][n + 499]) * kRate / 2;
    velocity[n] = felt.of[1][n + 500];
  }
  EXPECT_LT(relative_error_db(slope, velocity), -20);  // the bar's modes reach 4 kHz, and friction has corners
}

TEST(Pickup, OfAnObjectWithANewBankFeelsTheOldOneRingOut) {
  const Map map = map_of(random_bank(6, 40, 20));
  const auto play = [&](bool replaced) {
    Felt felt;
    felt.install(map);
    felt.push(pickup_at(0, 0, point_of(map->bank(), 4), 1));
    felt.push(vertex_strike_at(0, 0, 1, {1, 2, 3}));
    felt.render(700);
    if (replaced) felt.install(map);
    felt.render(700);
    return felt.of[0];
  };
  EXPECT_LT(relative_error_db(play(true), play(false)), -110);
}

TEST(Pickup, OfAChangingSampleRateKeepsItsLevel) {
  const modal::Bank bank = single_mode_bank(500, 0, {0, 0, 1});
  Felt felt;
  felt.install(map_of(bank));
  felt.push(pickup_at(0, 0, {1, 1, 1}, 1, 1, {0, 0, 1}));
  felt.push(strike_at(0, 0, {0, 0, 2}));
  felt.render(1000);
  felt.mixer.change_sample_rate(96000);
  felt.render(1000);
  const double f = 500;
  for (std::size_t n = 0; n < 1000; ++n) {
    const double t = 1000 / kRate + static_cast<double>(n) / 96000;
    ASSERT_NEAR(felt.of[0][1000 + n], 2 * answer(f, 0, t, 1), 1e-5) << n;
  }
}

TEST(Pickup, OfAHeardObjectDoesNotCareWhereTheListenerIs) {
  const Map map = map_of(random_bank(7, 200, 20));
  const auto play = [&](bool listener) {
    Felt felt;
    felt.install(map);
    felt.push(pickup_at(0, 0, point_of(map->bank(), 4), 1));
    if (listener) {
      felt.push({.frame = 0, .object = 0, .verb = verb::Pose{{{3, 1, 0}, {}}}});
      felt.push({.frame = 0, .verb = verb::Listener{}});
    }
    felt.push(vertex_strike_at(100, 0, 1, {1, 2, 3}));
    felt.push(vertex_strike_at(391, 0, 2, {1, 0, 3}));
    felt.render(3000);
    return felt.of[0];
  };
  EXPECT_LT(relative_error_db(play(true), play(false)), -105);
}

TEST(Pickup, OfObjectsThatShareABankTellsThemApart) {
  const Map map = map_of(random_bank(8, 100, 20));
  Felt felt;
  const auto table = felt.mixer.table_for(map, {});
  for (ObjectNumber object = 0; object < 3; ++object)
    ASSERT_TRUE(felt.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
  for (ObjectNumber object = 0; object < 3; ++object) felt.push(vertex_strike_at(0, object, object, {1, 2, 3}));
  felt.push(pickup_at(500, 1, point_of(map->bank(), 4), 0));
  felt.render(2000);
  Samples wanted = direct_sum(map->bank(), std::array{Blow{0, 1, {1, 2, 3}}}, 4, 0, 2000);
  std::fill_n(wanted.begin(), 500, 0.0);
  EXPECT_LT(relative_error_db(felt.of[0], wanted), -100);
}

TEST(Pickup, MovesToTheLastObjectThatAskedForIt) {
  const Map map = map_of(random_bank(9, 30, 20));
  Felt felt;
  for (ObjectNumber object = 0; object < 2; ++object) {
    felt.install(map, object);
    felt.push(vertex_strike_at(0, object, object + 1, {1, 2, 3}));
  }
  felt.push(pickup_at(0, 0, point_of(map->bank(), 4), 0));
  felt.push(pickup_at(900, 1, point_of(map->bank(), 4), 0));
  felt.render(2000, 333);
  Samples wanted = direct_sum(map->bank(), std::array{Blow{0, 1, {1, 2, 3}}}, 4, 0, 2000);
  const Samples other = direct_sum(map->bank(), std::array{Blow{0, 2, {1, 2, 3}}}, 4, 0, 2000);
  std::copy(other.begin() + 900, other.end(), wanted.begin() + 900);
  EXPECT_LT(relative_error_db(felt.of[0], wanted), -100);
}

TEST(Pickup, RefusesWhatCannotBe) {
  const Map map = map_of(random_bank(9, 30, 20));
  Felt felt;
  felt.install(map);
  felt.push(pickup_at(0, 0, {}, 0, 0));
  felt.push(pickup_at(0, 0, {}, 0, kMaxPickups + 1));
  felt.push(pickup_at(0, 0, {}, 0, 1, {}));  // there is none to remove
  felt.push(pickup_at(0, 0, {std::nan(""), 0, 0}, 0, 1));
  felt.render(100);
  EXPECT_EQ(felt.mixer.counters().refused, 4u);
  // Each of the eight has room for one move in a chunk; more are refused, and later ones work again.
  for (std::uint32_t k = 0; k < 20; ++k) felt.push(pickup_at(100 + k, 0, {0.1, 0, 0}, 0, 1 + k % 2));
  felt.render(400, 400);
  felt.push(vertex_strike_at(500, 0, 1, {1, 2, 3}));
  felt.push(pickup_at(500, 0, point_of(map->bank(), 4), 0, 2));
  felt.render(400);
  EXPECT_GT(peak(Samples(felt.of[1].end() - 400, felt.of[1].end())), 0);
}

TEST(Pickup, OfARemovedObjectIsSilentWhenItsNumberIsUsedAgain) {
  const Map map = map_of(random_bank(10, 30, 20));
  Felt felt;
  felt.install(map);
  felt.push(pickup_at(0, 0, point_of(map->bank(), 4), 1));
  felt.push(vertex_strike_at(0, 0, 1, {1, 2, 3}));
  felt.render(300);
  ASSERT_TRUE(felt.mixer.remove(0));
  felt.render(1000);
  felt.mixer.collect();
  ASSERT_FALSE(felt.mixer.in_use(0));
  felt.install(map);
  felt.push(vertex_strike_at(1300, 0, 1, {1, 2, 3}));
  felt.render(500);
  EXPECT_GT(peak(Samples(felt.of[0].begin(), felt.of[0].begin() + 300)), 0);
  EXPECT_EQ(peak(Samples(felt.of[0].end() - 500, felt.of[0].end())), 0);
}

// A mode that radiates next to nothing rests early in the mix; a pickup feels it for longer.
TEST(Pickup, FeelsAModeThatIsHardlyHeard) {
  const modal::Bank bank = single_mode_bank(100, 2, {0, 0, 1});
  Felt felt;
  felt.install(map_of(bank));
  felt.push(gain_at(0, 0, 1));
  felt.push(pickup_at(0, 0, {1, 1, 1}, 0, 1, {0, 0, 1}));
  felt.push(strike_at(0, 0, {0, 0, 1e-3}));  // some -100 dB in the mix
  felt.render(static_cast<std::size_t>(3 * kRate), 1024);
  const Samples end(felt.of[0].end() - 1000, felt.of[0].end());
  EXPECT_NEAR(peak(end) / (1e-3 / (2 * std::numbers::pi * 100) * std::exp(-2 * 2.98)), 1, 0.03);
}

}  // namespace
}  // namespace ringdown::synth::test
