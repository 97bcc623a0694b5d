// Gives a baked bank the damping of a recording's modes, or makes a bank of these modes alone. [worker]
//
// Calibration matches the recording's modes to the bank's by frequency, up to one factor common to all (a different
// size, temperature or modulus). It then fits Rayleigh's alpha and beta to the decays, d = (alpha + beta lambda)/2,
// neither below 0, by least squares on relative errors, in which modes of equal error have equal weight. Modes whose
// decay is far off (clamped, coupled, matched wrongly) are left out by Tukey's biweight [Beaton & Tukey, Technometrics
// 16(2), 1974].
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
  bool used = false;            // true: used for alpha and beta
};

struct Calibration {
  modal::RayleighDamping damping;
  double tuning_cents = 0;  // common factor of the recording's over the bank's frequencies
  double spread = 0;        // exp(standard deviation of log(recorded / fitted decay)) - 1
  std::vector<Match> matches;
  [[nodiscard]] std::size_t used() const;
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

// The bank with `damping`: decays, damped frequencies, material. The recording's decays include the losses to the air,
// so the bank no longer states these losses separately. A mode that would be over-damped is dropped. A bank without a
// material stays without one.
modal::Bank with_damping(const modal::Bank& bank, const modal::RayleighDamping& damping);

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
