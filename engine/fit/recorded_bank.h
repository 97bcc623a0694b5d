// Gives a baked bank the damping of a recording's modes, or makes a bank of these modes alone. [worker]
//
// Calibration: the recording's modes are matched to the bank's by frequency, up to one factor for all (another size,
// temperature or modulus), and Rayleigh's alpha and beta are fitted to what decays: d = (alpha + beta lambda)/2,
// neither below 0, by least squares in which one mode counts as much as another of the same relative error; modes whose
// decay is far off (clamped, coupled, matched wrongly) are left out, as Tukey's biweight does [Beaton & Tukey,
// Technometrics 16(2), 1974].
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
  double off_cents = 0;         // what is left of the recorded over the baked frequency after the common factor
  bool used = false;            // for alpha and beta
};

struct Calibration {
  modal::RayleighDamping damping;
  double tuning_cents = 0;  // the recording over the bank: what the frequencies have in common
  double spread = 0;        // of recorded over fitted decays: exp of the standard deviation of the logarithm, less 1
  std::vector<Match> matches;
  [[nodiscard]] std::size_t used() const;
};

struct CalibrateOptions {
  double tolerance_cents = 30;    // a match is no further off, after the common factor
  double max_tuning_cents = 200;  // the largest common factor that is looked for, up or down
  double around_cents = 0;        // from here
};

// Fails when fewer than kMinMatches modes match: then it is another thing, or another kind of blow.
Result<Calibration> calibrate(std::span<const Mode> recorded, const modal::Bank& bank,
                              const CalibrateOptions& options = {});

inline constexpr std::size_t kMinMatches = 3;

// The bank with that damping: decays, damped frequencies, material. The recording's decays contain what the air took,
// so the bank no longer says what of them that is. A mode that would be over-damped is dropped. A bank without a
// material stays without.
modal::Bank with_damping(const modal::Bank& bank, const modal::RayleighDamping& damping);

// The blow that was recorded.
struct Blow {
  Vec3 impulse_ns = {0, 0, 1};  // what should sound as loud as the recording; not 0
  double contact_time_s = 0;    // with this contact time, F(f) of which is divided out, by 20 dB at most
};

// The largest pressure [Pa] at 1 m, rms over directions, in the first half second after an impulse of `impulse_ns` at
// the bank's first point, without contact time, in the direction in which that point's modes move most.
double peak_pressure_pa(const modal::Bank& bank, double impulse_ns);

// A bank that plays the recording's modes, and states the pressure of a blow of kPeakBlow_ns: one sample point, which
// moves along the recorded blow. `loudness`: a mode's amplitude in the mixer's output over 2 pi f F(f) (phi . j), for
// one channel and an object in the centre (docs/how/physics.md, "A strike"). Shapes have the sign of the recorded sine
// at the onset: the mixer's sines begin at phase 0, so of the recorded phases no more than that can be kept. The modes
// of a `burst` (burst.h) stand last, as the least important ones.
modal::Bank to_bank(std::span<const Mode> modes, const Blow& blow, double loudness, const std::string& name,
                    std::span<const Mode> burst = {});

}  // namespace ringdown::fit
