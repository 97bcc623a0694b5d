// Gives a baked bank the damping of a recording's modes, or makes a bank of these modes alone. [worker]
//
// Calibration matches the recording's modes to the bank's by frequency, up to one factor common to all (a different
// size, temperature or modulus). What the bank says that air, heat and supports take of a mode comes off its decay; the
// rest is the material's, d = eta(f) omega / 2. Its loss factor is fitted at one to three frequencies, between which
// log eta is linear in log f, by least squares of log eta: one figure unless more of them explain the decays better by
// Akaike's criterion. Modes whose decay is far off (clamped, coupled, matched wrongly) are left out by Tukey's biweight
// [Beaton & Tukey, Technometrics 16(2), 1974].
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/fit/modes.h"
#include "engine/modal/bank.h"

#include <span>
#include <string>
#include <vector>

namespace ringdown::fit {

struct Match {
  std::size_t recorded, baked;  // numbers of the modes
  double off_cents = 0;         // recorded over baked frequency after the common factor
  bool used = false;            // true: used for the loss factors
};

struct Calibration {
  std::vector<modal::LossFactor> loss_factors;  // 1 to 3, by ascending frequency
  std::vector<double> loss_errors;              // relative standard error of each
  double tuning_cents = 0;                      // common factor of the recording's over the bank's frequencies
  double spread = 0;                            // exp(standard deviation of log(recorded / fitted decay)) - 1
  std::vector<Match> matches;
  [[nodiscard]] std::size_t used() const;
  [[nodiscard]] std::string text() const;  // "0.0012 +- 3 % at 1200 Hz", of each loss factor
};

struct CalibrateOptions {
  double tolerance_cents = 30;    // largest deviation of a match after the common factor
  double max_tuning_cents = 200;  // largest common factor in the search, up or down
  double around_cents = 0;        // centre of the search
};

// Fails when fewer than kMinMatches modes match. The recording is then of another object, or of another kind of blow.
Result<Calibration> calibrate(std::span<const Mode> recorded, const modal::Bank& bank,
                              const CalibrateOptions& options = {});

inline constexpr std::size_t kMinMatches = 3;

// The losses of the bank's mode `baked` at a frequency near its own, with what the recording's material takes.
modal::ModeLoss fitted_loss(const Calibration& calibration, const modal::Bank& bank, std::size_t baked,
                            double frequency_hz);

// The bank with the recording's loss factors: decays, damped frequencies, losses, material. A mode that would be
// over-damped is dropped. A bank without a material stays without one.
modal::Bank with_losses(const modal::Bank& bank, const Calibration& calibration);

// The blow that was recorded.
struct Blow {
  Vec3 impulse_ns = {0, 0, 1};  // impulse that should sound as loud as the recording; not 0
  double contact_time_s = 0;    // contact time of the blow; its F(f) is divided out, by at most 20 dB
};

// The largest pressure [Pa] at 1 m, rms over directions, in the first half second after an impulse of `impulse_ns` at
// the bank's first point, without contact time, in the direction in which that point's modes move most.
double peak_pressure_pa(const modal::Bank& bank, double impulse_ns);

// A bank that plays the recording's modes, and states the pressure of a blow of kPeakBlow_ns. It has one sample point,
// which moves along the recorded blow. `loudness` is a mode's amplitude in the mixer's output, for one channel and an
// object in the centre, over 2 pi f F(f) (phi . j) (docs/how/physics.md, "A strike"). Shapes have the sign of the
// recorded sine at the onset; the rest of the phase is lost, because the mixer's sines begin at phase 0. The modes of a
// `burst` (burst.h) come last, as the least important ones.
modal::Bank to_bank(std::span<const Mode> modes, const Blow& blow, double loudness, const std::string& name,
                    std::span<const Mode> burst = {});

}  // namespace ringdown::fit
