// Modes of coupled oscillators, against closed forms and against motion computed step by step.
#include "engine/tube/coupled.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace ringdown::tube {
namespace {

using Complex = std::complex<double>;

constexpr double kOmega = 1382.3, kBarDecay = 0.515, kTubeDecay = 8.6;

Oscillators pair_of(double bond, double detuning = 0) {
  Oscillators two;
  two.bar = Eigen::VectorXcd::Constant(1, Complex(kOmega, -kBarDecay));
  two.tube = Eigen::VectorXcd::Constant(1, Complex(kOmega + detuning, -kTubeDecay));
  two.bond = Eigen::MatrixXcd::Constant(1, 1, bond);
  return two;
}

TEST(CoupledModes, WeakTubeOnlyDampsTheBar) {
  const double bond = 1.96, half = (kTubeDecay - kBarDecay) / 2;
  const CoupledModes modes = coupled_modes(pair_of(bond));
  const double root = std::sqrt(half * half - bond * bond);
  EXPECT_NEAR(modes.omega_rad_s[0].real(), kOmega, 1e-9);
  EXPECT_NEAR(-modes.omega_rad_s[0].imag(), kBarDecay + half - root, 1e-9);
  EXPECT_NEAR(-modes.omega_rad_s[1].imag(), kBarDecay + half + root, 1e-9);
}

TEST(CoupledModes, StrongTubeMakesTwoPitchesThatBeat) {
  const double bond = 6, half = (kTubeDecay - kBarDecay) / 2;
  const CoupledModes modes = coupled_modes(pair_of(bond));
  const double beat = 2 * std::sqrt(bond * bond - half * half);
  EXPECT_NEAR(std::abs(modes.omega_rad_s[0].real() - modes.omega_rad_s[1].real()), beat, 1e-9);
  for (const int n : {0, 1}) EXPECT_NEAR(-modes.omega_rad_s[n].imag(), (kBarDecay + kTubeDecay) / 2, 1e-9);
}

TEST(CoupledModes, FarTubeLeavesTheBarAlone) {
  const CoupledModes modes = coupled_modes(pair_of(1e-3, 500));
  EXPECT_NEAR(modes.omega_rad_s[0].real() / kOmega, 1, 1e-10);
  EXPECT_NEAR(-modes.omega_rad_s[0].imag() / kBarDecay, 1, 1e-9);
  EXPECT_NEAR(std::abs(modes.mixing(0, 0) - 1.0), 0, 1e-9);
}

// There the modes' amplitudes grow without bound; half a cent away they are large, and their sum is still right.
TEST(CoupledModes, ExceptionalPointIsAvoided) {
  const CoupledModes modes = coupled_modes(pair_of((kTubeDecay - kBarDecay) / 2));
  EXPECT_TRUE(modes.detuned);
  EXPECT_TRUE(modes.mixing.allFinite());
  EXPECT_LT(modes.mixing.cwiseAbs().maxCoeff(), 30);
  EXPECT_NEAR(std::abs((modes.mixing * modes.mixing.transpose() - Eigen::MatrixXcd::Identity(2, 2)).sum()), 0, 1e-9);
}

// A blow on the bar, by the modes and by the classical method of Runge and Kutta; the energy of both never grows.
TEST(CoupledModes, SumOfTheModesIsTheMotion) {
  for (const double bond : {1.96, 4.0, 6.0}) {
    for (const double detuning : {0.0, 20.0}) {
      const Oscillators two = pair_of(bond, detuning);
      const CoupledModes modes = coupled_modes(two);
      constexpr double kStep_s = 2e-4;
      Eigen::Vector2cd state(1, 0);
      Eigen::Matrix2cd matrix;
      matrix << two.bar[0] - kOmega, bond, bond, two.tube[0] - kOmega;  // in a frame that turns along
      const auto slope = [&](const Eigen::Vector2cd& at) -> Eigen::Vector2cd { return Complex(0, -1) * (matrix * at); };
      double before = 1;
      for (int step = 1; step <= 4000; ++step) {
        const Eigen::Vector2cd a = slope(state), b = slope(state + kStep_s / 2 * a), c = slope(state + kStep_s / 2 * b),
                               d = slope(state + kStep_s * c);
        state += kStep_s / 6 * (a + 2 * b + 2 * c + d);
        const double time = step * kStep_s;
        Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
        for (int n = 0; n < 2; ++n) {
          sum += modes.mixing.col(n) * modes.mixing(0, n) *
                 std::exp(Complex(0, -1) * (modes.omega_rad_s[n] - kOmega) * time);
        }
        if (!modes.detuned) {
          ASSERT_LT((sum - state).norm(), 1e-7) << bond << " " << detuning;
        }
        const double energy = sum.squaredNorm();
        ASSERT_LE(energy, before * (1 + 1e-12));
        before = energy;
      }
    }
  }
}

// After a blow on the bar the tube is silent at first, so that its sound is that of two modes of opposite sign.
TEST(CoupledModes, TubeBeginsSilent) {
  for (const double bond : {1.0, 3.9, 8.0}) {
    const CoupledModes modes = coupled_modes(pair_of(bond, 3));
    const Complex bar_like = modes.mixing(0, 0) * modes.mixing(1, 0),
                  tube_like = modes.mixing(0, 1) * modes.mixing(1, 1);
    EXPECT_LT(std::abs(bar_like + tube_like), 1e-10 * std::abs(bar_like));
  }
}

}  // namespace
}  // namespace ringdown::tube
