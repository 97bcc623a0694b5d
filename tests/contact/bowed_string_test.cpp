// A bow on a string, against what theory says of it: Friedlander's jumps and Schelleng's least force.
#include "engine/contact/network.h"
#include "tests/contact/modal_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace ringdown::contact {
namespace {

constexpr double kRate_hz = 48000, kStep_s = 1 / kRate_hz;

// A bow pressed by `force_n` on a surface that a newton moves by `compliance_m_n` in a step.
Contact bow_of(double force_n, double stribeck_m_s, double compliance_m_n) {
  const double bristle = std::min(2e6, 0.5 / compliance_m_n);
  return {.load_n = force_n,
          .friction = FrictionLaw{.static_coefficient = 0.8,
                                  .sliding_coefficient = 0.3,
                                  .stribeck_m_s = stribeck_m_s,
                                  .bristle_n_m = bristle,
                                  .bristle_ns_m = 0.3 * kStep_s *
                                                  std::min(1 / compliance_m_n, std::sqrt(bristle / compliance_m_n))},
          .directions = 1};
}

// An endless string of impedance Z, moved by the waves that come in: the bow slips by v = free - f / (2 Z). Where the
// friction falls more steeply than 2 Z, the speed of slip jumps, up where sticking fails, and down where slipping does,
// at another free speed (Friedlander, Proc. Camb. Phil. Soc. 49, 1953).
struct Jumps {
  double up_m_s = 0, down_m_s = 0;  // free speeds
};
Jumps sweep(double impedance, double stribeck_m_s) {
  constexpr int kSteps = 200'000;
  constexpr double kSlips_m_s = 0.02;
  const double compliance = kStep_s / (2 * impedance), top = 0.6 / impedance + 0.5;
  Contact bow = bow_of(1, stribeck_m_s, compliance);
  Network network;
  EXPECT_TRUE(network.add(bow));
  network.set_compliance(0, 0, compliance);
  Jumps jumps;
  for (int i = 0; i < 2 * kSteps; ++i) {
    const bool rises = i < kSteps;
    const double free = top * (rises ? i : 2 * kSteps - i) / kSteps;
    std::array<double, kMaxFreedoms> change{free * kStep_s}, force{};
    network.step(change, kStep_s, force);
    const double slip = free - force[0] / (2 * impedance);
    if (rises && jumps.up_m_s == 0 && slip > kSlips_m_s) jumps.up_m_s = free;
    if (!rises && jumps.down_m_s == 0 && slip < kSlips_m_s) jumps.down_m_s = free;
  }
  return jumps;
}

TEST(BowedString, JumpsWhereFriedlandersConstructionDoes) {
  constexpr double kStribeck_m_s = 0.1;
  // The steepest fall of 0.5 / (1 + (v / v_s)^2) is 3 sqrt(3) / 8 of 0.5 / v_s: 3.25 kg/s.
  for (const double impedance : {0.2, 0.4, 1.0}) {
    double lowest = 1e9;  // free speed at which the string can slip
    for (double v = 0.02; v < 5; v += 1e-5) {
      const double friction = 0.3 + 0.5 / (1 + std::pow(v / kStribeck_m_s, 2));
      lowest = std::min(lowest, v + friction / (2 * impedance));
    }
    const Jumps jumps = sweep(impedance, kStribeck_m_s);
    EXPECT_NEAR(jumps.up_m_s, 0.8 / (2 * impedance), 0.015) << "all that sticking can hold, and a little creep";
    EXPECT_NEAR(jumps.down_m_s, lowest, 0.005 * lowest);
    EXPECT_GT(jumps.up_m_s, 1.05 * jumps.down_m_s);
  }
  for (const double impedance : {2.0, 5.0}) {
    const Jumps jumps = sweep(impedance, kStribeck_m_s);
    EXPECT_NEAR(jumps.up_m_s, jumps.down_m_s, 1e-3) << "a string too heavy to jump";
  }
}

// A string of 220 Hz whose end loses energy as into a resistance R; bowed at `place` of its length, Helmholtz's corner
// already on its way.
constexpr double kPitch_hz = 220, kImpedance = 0.4, kEnd = 150 * kImpedance, kLength_m = 0.325;

bool keeps_helmholtz_motion(double place, double speed_m_s, double force_n) {
  constexpr int kModes = 60, kPeriods = 120, kCounted = 30;
  const double mass_kg = kImpedance / (2 * kLength_m * kPitch_hz) * kLength_m;
  const double omega = 2 * std::numbers::pi * kPitch_hz, decay = 2 * kImpedance * kPitch_hz / kEnd;
  ModalBody string(kStep_s);
  const double corner = -speed_m_s / (omega * std::numbers::pi * place / 2), shape = std::sqrt(2 / mass_kg);
  for (int n = 1; n <= kModes; ++n) {
    string.add(n * omega, decay, {shape * std::sin(n * std::numbers::pi * place)});
    string.kick(static_cast<std::size_t>(n - 1), corner * omega / n / shape);
  }
  const double compliance = string.compliance(0, 0);
  Contact bow = bow_of(force_n, 0.05, compliance);
  Network network;
  EXPECT_TRUE(network.add(bow));
  network.set_compliance(0, 0, compliance);
  constexpr int kFrames = static_cast<int>(kPeriods * kRate_hz / kPitch_hz);
  constexpr int kFrom = static_cast<int>((kPeriods - kCounted) * kRate_hz / kPitch_hz);
  int slips = 0;
  double slipping_s = 0;
  bool slipped = false;
  for (int i = 0; i < kFrames; ++i) {
    std::array<double, kMaxFreedoms> change{speed_m_s * kStep_s - string.free_change(0)}, force{};
    network.step(change, kStep_s, force);
    string.step({force[0]});
    const bool slips_now = std::abs(speed_m_s - string.velocity(0)) > 0.3 * speed_m_s;
    if (i >= kFrom) slips += slips_now && !slipped ? 1 : 0, slipping_s += slips_now ? kStep_s : 0;
    slipped = slips_now;
  }
  const double share = slipping_s * kPitch_hz / kCounted;  // of a period
  return std::abs(slips - kCounted) <= 2 && std::abs(share - place) < 0.6 * place;
}

// One slip in each period, from Schelleng's least force Z^2 v / (2 R b^2 (mu_s - mu_d)) on (J. Acoust. Soc. Am. 53, 26
// (1973)), and never above his greatest, 2 Z v / (b (mu_s - mu_d)).
TEST(BowedString, KeepsHelmholtzMotionFromSchellengsLeastForceOn) {
  constexpr double kDifference = 0.5;
  for (const auto& [place, speed_m_s] : {std::pair(0.09, 0.1), std::pair(0.09, 0.2), std::pair(0.19, 0.1)}) {
    const double min = kImpedance * kImpedance * speed_m_s / (2 * kEnd * place * place * kDifference);
    const double greatest = 2 * kImpedance * speed_m_s / (place * kDifference);
    double low = 0.3 * min, high = 3 * min;
    EXPECT_FALSE(keeps_helmholtz_motion(place, speed_m_s, low));
    EXPECT_TRUE(keeps_helmholtz_motion(place, speed_m_s, high));
    EXPECT_FALSE(keeps_helmholtz_motion(place, speed_m_s, 1.5 * greatest));
    for (int i = 0; i < 4; ++i) {
      const double middle = std::sqrt(low * high);
      (keeps_helmholtz_motion(place, speed_m_s, middle) ? high : low) = middle;
    }
    std::printf("at %.2f, %.1f m/s: from %.3f N, Schelleng %.3f N\n", place, speed_m_s, high, min);
    EXPECT_LT(std::abs(std::log2(high / min)), 1) << "it begins within a factor of two";
  }
}

}  // namespace
}  // namespace ringdown::contact
