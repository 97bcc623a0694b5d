#include "engine/fit/comparison.h"

#include "engine/fit/band_powers.h"
#include "engine/modal/damping.h"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::fit {
namespace {

constexpr double kSame_cents = 4;       // two recordings' estimates of one mode
constexpr double kMostDecay_ratio = 3;  // what differs more is another mode at the same pitch

double cents_between(double a, double b) { return 1200 * std::log2(a / b); }

double misfit_cents(std::span<const Mode> heard, const Calibration& found, double tolerance) {
  double sum = static_cast<double>(heard.size() - found.matches.size()) * tolerance * tolerance;
  for (const Match& match : found.matches) sum += match.off_cents * match.off_cents;
  return std::sqrt(sum / static_cast<double>(heard.size()));
}

}  // namespace

std::vector<Mode> merge(std::span<const std::vector<Mode>> recordings) {
  std::vector<Mode> all;
  for (const std::vector<Mode>& modes : recordings) {
    double loudest = 0;
    for (const Mode& mode : modes) loudest = std::max(loudest, mode.amplitude);
    for (const Mode& mode : modes) {
      if (mode.amplitude > loudest * std::pow(10, -kFaint_db / 20)) all.push_back(mode);
    }
  }
  std::ranges::sort(all, {}, &Mode::frequency_hz);
  std::vector<Mode> merged;
  std::vector<double> weights;
  for (const Mode& mode : all) {
    const double weight = 1 / std::max(std::pow(mode.decay_error_per_s / mode.decay_per_s, 2), 1e-8);
    Mode* last = merged.empty() ? nullptr : &merged.back();
    const bool same = last && cents_between(mode.frequency_hz, last->frequency_hz) < kSame_cents &&
                      std::abs(std::log(mode.decay_per_s / last->decay_per_s)) < std::log(kMostDecay_ratio);
    if (!same) {
      merged.push_back(mode), weights.push_back(weight);
      continue;
    }
    const double part = weight / (weight + weights.back());
    last->frequency_hz += part * (mode.frequency_hz - last->frequency_hz);
    last->decay_per_s += part * (mode.decay_per_s - last->decay_per_s);
    last->amplitude = std::max(last->amplitude, mode.amplitude);
    last->decay_error_per_s = std::min(last->decay_error_per_s, mode.decay_error_per_s);
    last->frequency_error_hz = std::min(last->frequency_error_hz, mode.frequency_error_hz);
    weights.back() += weight;
  }
  return merged;
}

Result<NuChoice> choose_nu(std::span<const Mode> heard, std::span<const NuBank> banks,
                           const CalibrateOptions& options) {
  constexpr double kTelling_cents = 0.5;  // that the misfit changes by at least from one bank to the next
  std::vector<double> squares;
  for (const NuBank& bank : banks) {
    const Result<Calibration> found = calibrate(heard, *bank.bank, options);
    if (!found) return fail(found.error());
    squares.push_back(std::pow(misfit_cents(heard, *found, options.tolerance_cents), 2));
  }
  const auto at = static_cast<std::size_t>(std::ranges::min_element(squares) - squares.begin());
  NuChoice choice{banks[at].poisson_ratio, std::sqrt(squares[at]), false};
  if (at == 0 || at + 1 == squares.size()) return choice;
  const double x0 = banks[at - 1].poisson_ratio, x1 = banks[at].poisson_ratio, x2 = banks[at + 1].poisson_ratio;
  const double left = (squares[at] - squares[at - 1]) / (x1 - x0), right = (squares[at + 1] - squares[at]) / (x2 - x1);
  const double curvature = (right - left) / (x2 - x0);
  if (!(curvature > 0)) return choice;
  choice.poisson_ratio = std::clamp(0.5 * (x0 + x1) - 0.5 * left / curvature, x0, x2);
  choice.told = std::sqrt(std::max(squares[at - 1], squares[at + 1])) - choice.misfit_cents > kTelling_cents;
  return choice;
}

std::vector<Mode> as_recorded(std::span<const Mode> recording, const modal::Bank& bank, const Calibration& calibration,
                              const CalibrateOptions& options) {
  std::vector<Mode> modes;
  const double tuning = std::exp2(calibration.tuning_cents / 1200);
  for (const Match& match : calibration.matches) {
    const double lambda =
        tuning * tuning * modal::undamped_lambda({bank.frequency_hz[match.baked], bank.decay_per_s[match.baked]});
    const modal::DampedMode baked = modal::damp(lambda, calibration.damping);
    const auto nearest = std::ranges::min_element(
        recording, {}, [&](const Mode& mode) { return std::abs(mode.frequency_hz - baked.frequency_hz); });
    if (nearest == recording.end()) continue;
    if (std::abs(cents_between(nearest->frequency_hz, baked.frequency_hz)) > options.tolerance_cents) continue;
    Mode mode = *nearest;
    mode.frequency_hz = baked.frequency_hz, mode.decay_per_s = baked.decay_per_s;
    modes.push_back(mode);
  }
  return modes;
}

std::vector<double> spectrum_db(std::span<const double> samples, double sample_rate_hz, double low_hz, double high_hz,
                                std::size_t points) {
  std::size_t size = 1;
  while (size < 2 * samples.size()) size *= 2;
  std::vector<double> padded(size);
  for (std::size_t n = 0; n < samples.size(); ++n) {  // the second half of a Hann window: the blow is at the beginning
    padded[n] = samples[n] *
                (0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(n) / static_cast<double>(samples.size())));
  }
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, padded);
  std::vector<double> levels;
  const double bin = sample_rate_hz / static_cast<double>(size);
  for (std::size_t i = 0; i < points; ++i) {
    const auto edge = [&](std::size_t k) {
      return low_hz * std::pow(high_hz / low_hz, static_cast<double>(k) / static_cast<double>(points)) / bin;
    };
    const auto first = static_cast<std::size_t>(edge(i));
    const auto last = std::min(std::max(first + 1, static_cast<std::size_t>(edge(i + 1))), size / 2);
    double largest = 0;
    for (std::size_t k = first; k < last; ++k) largest = std::max(largest, std::norm(spectrum[k]));
    levels.push_back(power_db(largest));
  }
  return levels;
}

}  // namespace ringdown::fit
