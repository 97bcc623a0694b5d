// Tubes in another tuning, from the two modes that a tube has with its bar.
#include "engine/modal/damping.h"
#include "engine/modal/tubes/tube_bank.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

namespace ringdown::modal {
namespace {

using Complex = std::complex<double>;
using test::tubed_bank;
using test::TwoOscillators;

// Weak and strong pull, in tune and off, in front of an exceptional point and behind it.
const std::vector<TwoOscillators> kCases = {{},
                                            {.pull_rad_s = 1},
                                            {.pull_rad_s = 6},
                                            {.tube_hz = 223},
                                            {.bar_hz = 880, .tube_hz = 874, .tube_decay_per_s = 20, .pull_rad_s = 9}};

Complex complex_omega(const Bank& bank, std::size_t mode) {
  return {hz_to_rad_per_s(bank.frequency_hz[mode]), -bank.decay_per_s[mode]};
}

TwoOscillators retuned(TwoOscillators of, double cents, double opening) {
  const double ratio = std::exp2(cents / 1200);
  of.tube_hz *= ratio;
  of.tube_decay_per_s *= std::sqrt(ratio);  // friction at the wall
  of.pull_rad_s *= ratio * opening;
  return of;
}

void expect_alike(const Bank& bank, const Bank& other, double least, const std::string& what) {
  for (std::size_t m = 0; m < other.mode_count(); ++m) {
    EXPECT_LT(std::abs(complex_omega(bank, m) - complex_omega(other, m)), least * 10) << what << ", mode " << m;
    EXPECT_NEAR(bank.shape(m, 0)[2], other.shape(m, 0)[2], least) << what << ", mode " << m;
    const double heard = rms(other.radiation->maps.modes[m]);
    EXPECT_NEAR(rms(bank.radiation->maps.modes[m]) / heard, 1, least) << what << ", mode " << m;
  }
}

TEST(TubeBank, AtItsOwnTuningTheBankIsAsItWas) {
  for (const TwoOscillators& of : kCases) {
    const Bank bank = tubed_bank(of);
    const auto same = at_tuning(bank, {});
    ASSERT_TRUE(same) << same.error().message;
    expect_alike(same->bank, bank, 1e-5, std::to_string(of.pull_rad_s));
    const ModeTransfer none = transfer(as_tuned(bank).value(), same->modes, bank.mode_count());
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_NEAR(none.velocity[i], i % 4 == 0 ? 1 : 0, 1e-6);
      EXPECT_NEAR(none.turn[i], 0, 1e-6);
    }
  }
}

// The oracle couples the two oscillators by a formula of its own, in the other tuning.
TEST(TubeBank, AnotherTuningIsThatOfTheTwoOscillators) {
  for (const TwoOscillators& of : kCases) {
    const Bank bank = tubed_bank(of);
    for (const double cents : {-200.0, -30.0, -1.0, 7.0, 50.0}) {
      for (const double opening : {1.0, 0.4}) {
        const auto tuned = at_tuning(bank, {cents, opening});
        ASSERT_TRUE(tuned) << tuned.error().message;
        const Bank expected = tubed_bank(retuned(of, cents, opening));
        // What comes out of the tube follows the opening and the root of the pitch; the oracle's tube has not changed.
        const std::string what = std::to_string(cents) + " cents, " + std::to_string(opening);
        for (std::size_t m = 0; m < 2; ++m) {
          const auto off = [&](std::size_t n) {
            return std::abs(complex_omega(tuned->bank, m) - complex_omega(expected, n));
          };
          const std::size_t n = off(0) < off(1) ? 0 : 1;  // with a strong pull either may be called the tube's
          EXPECT_LT(off(n), 2e-3) << what << ", mode " << m;
          EXPECT_NEAR(std::abs(tuned->bank.shape(m, 0)[2]), std::abs(expected.shape(n, 0)[2]), 2e-3)
              << what << ", mode " << m;
          const double louder = opening * std::exp2(cents / 2400);
          const auto even = [](const Bank& of_bank, std::size_t mode) {
            return std::abs(Complex(of_bank.radiation->maps.modes[mode].terms[0].value));
          };
          EXPECT_NEAR(even(tuned->bank, m) / (louder * even(expected, n)), 1, 0.02) << what << ", mode " << m;
        }
      }
    }
  }
}

// The motion of bar and tube from the states of both modes.
std::array<Complex, 2> motion_of(const TubePair& pair, const std::array<Complex, 2>& states) {
  const Complex first = states[0] * pair.phase[0], second = states[1] * pair.phase[1];
  return {pair.mixing[0] * first + pair.mixing[1] * second, pair.mixing[2] * first + pair.mixing[3] * second};
}

double energy_of(const std::array<Complex, 2>& motion) { return std::norm(motion[0]) + std::norm(motion[1]); }

// From tuning to tuning, with some time between: energy falls while a tuning stays, and does not change with it.
TEST(TubeBank, EnergyFallsWhileATuningStaysAndIsKeptWhenItChanges) {
  for (const TwoOscillators& of : kCases) {
    const Bank bank = tubed_bank(of);
    TubeModes present = as_tuned(bank).value();
    Bank playing = bank;
    std::array<Complex, 2> states = {1, Complex(0.3, -0.5)};  // turning as exp(-i omega t)
    for (const double cents : {10.0, 10.0, -40.0, 300.0, 0.0, 0.2}) {
      const auto next = at_tuning(bank, {cents, cents > 100 ? 0.2 : 1});
      ASSERT_TRUE(next);
      const std::array<Complex, 2> before = motion_of(present.pairs[0], states);
      const ModeTransfer change = transfer(present, next->modes, bank.mode_count());
      const std::array<std::size_t, 2> at = {present.pairs[0].bar, present.pairs[0].tube};
      std::array<Complex, 2> moved{};
      for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t j = 0; j < 2; ++j)
          moved[i] += Complex(change.velocity[at[i] * 3 + at[j]], -change.turn[at[i] * 3 + at[j]]) * states[j];
      }
      const std::array<Complex, 2> after = motion_of(next->modes.pairs[0], moved);
      EXPECT_LT(std::abs(after[0] - before[0]) + std::abs(after[1] - before[1]), 1e-9 * std::sqrt(energy_of(before)));
      states = moved;
      present = next->modes;
      double energy = energy_of(motion_of(present.pairs[0], states));
      for (int step = 0; step < 100; ++step) {
        for (std::size_t n = 0; n < 2; ++n)
          states[n] *= std::exp(Complex(0, -1) * complex_omega(next->bank, at[n]) * 0.0013);
        const double now = energy_of(motion_of(present.pairs[0], states));
        EXPECT_LE(now, energy * (1 + 1e-9)) << cents << " cents, step " << step;
        energy = now;
      }
    }
  }
}

TEST(TubeBank, AClosedTubeLeavesTheBarAlone) {
  const TwoOscillators of;
  const auto closed = at_tuning(tubed_bank(of), {.opening = 0});
  ASSERT_TRUE(closed);
  EXPECT_NEAR(closed->bank.frequency_hz[0], of.bar_hz, 1e-5);
  EXPECT_NEAR(closed->bank.decay_per_s[0], of.bar_decay_per_s, 1e-4);
  EXPECT_NEAR(closed->bank.shape(0, 0)[2], test::kBarShape, 1e-4);
  EXPECT_NEAR(closed->bank.provenance.resonators[0].length_m, 0.37, 1e-9);
}

TEST(TubeBank, TheTubesShareOfTheSoundIsKnown) {
  const std::vector<double> shares = tube_shares(tubed_bank({}));
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_NEAR(shares[0], 1, 0.01);
  EXPECT_NEAR(shares[1], 1, 0.01);
  EXPECT_EQ(shares[2], 0);
  EXPECT_TRUE(tube_shares(test::single_mode_bank(440, 2)).empty());
}

TEST(TubeBank, ABankWithoutATubesPullIsRefusedWithASentence) {
  EXPECT_NE(at_tuning(test::single_mode_bank(440, 2), {}).error().message.find("[[resonator]]"), std::string::npos);
  Bank other = tubed_bank({});
  for (std::size_t p = 0; p < other.point_count(); ++p) other.shapes[other.point_count() + p] = {0, 1, 0};
  EXPECT_NE(at_tuning(other, {}).error().message.find("no two of its bank's modes"), std::string::npos);
  Bank twice = tubed_bank({});
  twice.provenance.resonators.push_back(twice.provenance.resonators[0]);
  EXPECT_NE(at_tuning(twice, {}).error().message.find("pull one mode"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::modal
