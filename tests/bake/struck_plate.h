// A thin steel plate whose nonlinear terms come from von_karman.h: as a bank for the mixer, and as equations that are
// integrated step by step.
#pragma once

#include "engine/modal/strike_map.h"
#include "engine/synth/modes/voice.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace ringdown::synth::test {

using Samples = std::vector<double>;

constexpr double kRate_hz = 48000, kDecay_per_s = 0.5, kSide_m = 0.2, kThickness_m = 0.002, kSeconds = 0.5;
constexpr int kModes = 16, kFunctions = 20;

struct Plate {
  Eigen::VectorXd omega;           // M
  std::vector<Eigen::MatrixXd> h;  // K, M x M
  Eigen::VectorXd shape;           // M: at the point that is struck
  double curving = 0;              // how large g is, as if the plate were a shell
};

Plate steel_plate(int modes = kModes, int functions = kFunctions);

// With `coupled`, that many modes exchange energy.
std::shared_ptr<const modal::StrikeMap> map_of(const Plate& plate, bool nonlinear, int coupled = 0,
                                               double decay_per_s = kDecay_per_s);

// q'' + 2 d q' + omega^2 q + sum over k of 2 t_k H^k q = 0, after a blow: each mode's velocity at the mixer's rate. The
// largest deflection of the struck point goes to `peak_m`, and the sum of the modes' accelerations, which is heard, to
// `heard`; each sample takes so many steps.
std::vector<Samples> integrated(const Plate& plate, double impulse_ns, double& peak_m, int steps = 6,
                                Samples* heard = nullptr);

std::unique_ptr<Voice> struck(const Plate& plate, bool nonlinear, double impulse_ns, int coupled = 0);

Samples by_tables(Voice& voice, std::size_t frames);

}  // namespace ringdown::synth::test
