#include "engine/fit/comparison.h"

#include "engine/fit/band_powers.h"
#include "engine/modal/damping.h"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>

namespace ringdown::fit {
namespace {

constexpr double kSame_cents = 4;      // largest difference of two recordings' estimates of one mode
constexpr double kMaxDecay_ratio = 3;  // modes whose decays differ more are two modes of one pitch

double cents_between(double a, double b) { return 1200 * std::log2(a / b); }

double nearest_cents(const std::vector<double>& ascending, double frequency) {
  const auto above = std::ranges::lower_bound(ascending, frequency);
  double off = INFINITY;
  if (above != ascending.end()) off = std::abs(cents_between(frequency, *above));
  if (above != ascending.begin()) off = std::min(off, std::abs(cents_between(frequency, *(above - 1))));
  return off;
}

// The mean square deviation of the heard modes, plus a share of that of the baked modes below the highest heard one.
// The baked modes count because in a dense bank some mode lies near every heard one, while a mode that an object has is
// mostly heard.
double mean_square_cents(const std::vector<double>& heard, const std::vector<double>& baked, double tuning_cents,
                         double tolerance) {
  constexpr double kOfBaked = 0.25;
  const double factor = std::exp2(tuning_cents / 1200), max = tolerance * tolerance;
  double sum = 0, other = 0;
  std::size_t count = 0;
  for (const double f : heard) sum += std::min(std::pow(nearest_cents(baked, f / factor), 2), max);
  for (const double f : baked) {
    if (f * factor > heard.back()) break;
    other += std::min(std::pow(nearest_cents(heard, f * factor), 2), max);
    ++count;
  }
  return sum / static_cast<double>(heard.size()) +
         kOfBaked * other / static_cast<double>(std::max<std::size_t>(count, 1));
}

// The number of baked modes that have a heard mode within the tolerance. A heard mode counts for its nearest one.
std::size_t count_matches(const std::vector<double>& heard, const std::vector<double>& baked, double tuning_cents,
                          double tolerance) {
  const double factor = std::exp2(tuning_cents / 1200);
  std::vector<bool> has(baked.size());
  for (const double f : heard) {
    const auto above = std::ranges::lower_bound(baked, f / factor);
    auto nearest = above == baked.end() ? above - 1 : above;
    if (above != baked.begin() && f * f < factor * factor * *nearest * *(above - 1)) nearest = above - 1;
    if (std::abs(cents_between(f / factor, *nearest)) <= tolerance)
      has[static_cast<std::size_t>(nearest - baked.begin())] = true;
  }
  return static_cast<std::size_t>(std::ranges::count(has, true));
}

double energy_of(const Mode& mode) { return mode.amplitude * mode.amplitude / mode.decay_per_s; }

// Returns whether `mode` is an artefact of a room, or of the end of a fit: such a mode lies near a stronger one, is
// shorter, and is much weaker.
bool is_companion(const Mode& mode, std::span<const Mode> recording) {
  constexpr double kShorter = 1.5, kStronger = 10;
  return std::ranges::any_of(recording, [&](const Mode& other) {
    return std::abs(cents_between(mode.frequency_hz, other.frequency_hz)) < kCompanion_cents &&
           mode.decay_per_s > kShorter * other.decay_per_s && energy_of(other) > kStronger * energy_of(mode);
  });
}

// One mode of the object, and the recordings that have it.
struct Merged {
  Mode mode;
  double weight;
  std::vector<std::size_t> recordings;

  [[nodiscard]] bool takes(const Mode& other, std::size_t recording) const {
    return std::abs(cents_between(other.frequency_hz, mode.frequency_hz)) < kSame_cents &&
           std::abs(std::log(other.decay_per_s / mode.decay_per_s)) < std::log(kMaxDecay_ratio) &&
           std::ranges::find(recordings, recording) == recordings.end();
  }
  void take(const Mode& other, double other_weight, std::size_t recording) {
    const double part = other_weight / (other_weight + weight);
    mode.frequency_hz += part * (other.frequency_hz - mode.frequency_hz);
    mode.decay_per_s += part * (other.decay_per_s - mode.decay_per_s);
    mode.amplitude = std::max(mode.amplitude, other.amplitude);
    mode.decay_error_per_s = std::min(mode.decay_error_per_s, other.decay_error_per_s);
    mode.frequency_error_hz = std::min(mode.frequency_error_hz, other.frequency_error_hz);
    weight += other_weight;
    recordings.push_back(recording);
  }
};

}  // namespace

std::vector<Mode> merge(std::span<const std::vector<Mode>> recordings) {
  std::vector<Merged> merged;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    double loudest = 0;
    for (const Mode& mode : recordings[r]) loudest = std::max(loudest, mode.amplitude);
    for (const Mode& mode : recordings[r]) {
      if (mode.amplitude < loudest * std::pow(10, -kFaint_db / 20) || is_companion(mode, recordings[r])) continue;
      const double weight = 1 / std::max(std::pow(mode.decay_error_per_s / mode.decay_per_s, 2), 1e-8);
      Merged* nearest = nullptr;
      for (Merged& m : merged) {
        const auto off = [&](const Merged& x) { return std::abs(x.mode.frequency_hz - mode.frequency_hz); };
        if (m.takes(mode, r) && (!nearest || off(m) < off(*nearest))) nearest = &m;
      }
      if (nearest) {
        nearest->take(mode, weight, r);
      } else {
        merged.push_back({mode, weight, {r}});
      }
    }
  }
  std::vector<Mode> modes;
  for (const Merged& m : merged) modes.push_back(m.mode);
  std::ranges::sort(modes, {}, &Mode::frequency_hz);
  return modes;
}

NuChoice choose_nu(std::span<const Mode> heard, const NuCurves& curves, const CalibrateOptions& options) {
  constexpr double kNuStep = 0.0025, kTuningStep = 2, kAside = 0.03, kTelling_cents = 0.5;
  std::vector<double> frequencies;
  for (const Mode& mode : heard) frequencies.push_back(mode.frequency_hz);
  const double low = curves.lowest(), high = curves.highest();
  const auto best_at = [&](double nu, double around, double max, double step) {
    const std::vector<double> baked = curves.at(nu);
    std::pair<double, double> best{INFINITY, around};  // mean square, tuning
    for (double tuning = around - max; tuning <= around + max; tuning += step) {
      best = std::min(best, {mean_square_cents(frequencies, baked, tuning, options.tolerance_cents), tuning});
    }
    return best;
  };
  NuChoice choice;
  double nearest = INFINITY;
  for (double nu = low; nu <= high + 1e-9; nu += kNuStep) {
    const auto [square, tuning] = best_at(nu, options.around_cents, options.max_tuning_cents, kTuningStep);
    if (square < nearest) {
      nearest = square;
      choice.poisson_ratio = nu;
      choice.tuning_cents = tuning;
    }
  }
  const auto [square, tuning] = best_at(choice.poisson_ratio, choice.tuning_cents, kTuningStep, 0.05);
  choice.tuning_cents = tuning;
  choice.misfit_cents = std::sqrt(square);
  const bool inside = choice.poisson_ratio > low + kNuStep && choice.poisson_ratio < high - kNuStep;
  const auto aside = [&](double nu) {
    return std::sqrt(best_at(std::clamp(nu, low, high), tuning, options.tolerance_cents, 0.5).first) -
           choice.misfit_cents;
  };
  const double rise = std::max(aside(choice.poisson_ratio - kAside), aside(choice.poisson_ratio + kAside));
  choice.told = inside && rise > kTelling_cents;
  return choice;
}

FigureChoice search_figures(std::span<const Mode> heard, const Slopes& slopes, std::span<const double> reach,
                            const CalibrateOptions& options) {
  constexpr double kTuningStep = 4, kBetter = 0.999;
  const std::size_t figures = slopes.slopes.size();
  const int side = figures <= 2 ? 9 : figures == 3 ? 5 : 2;  // steps to either side
  std::vector<double> frequencies;
  for (const Mode& mode : heard) frequencies.push_back(mode.frequency_hz);
  FigureChoice best{std::vector<double>(figures), options.around_cents};
  double least = INFINITY;
  const auto offer = [&](const std::vector<double>& changes) {
    std::vector<double> baked = slopes.frequency_hz;
    for (std::size_t k = 0; k < figures; ++k) {
      for (std::size_t m = 0; m < baked.size(); ++m) baked[m] *= std::exp(slopes.slopes[k][m] * changes[k]);
    }
    std::ranges::sort(baked);
    for (double tuning = -options.max_tuning_cents; tuning <= options.max_tuning_cents; tuning += kTuningStep) {
      const double at = options.around_cents + tuning;
      const double square = mean_square_cents(frequencies, baked, at, options.tolerance_cents);
      if (!(square < kBetter * least)) continue;
      least = square;
      best = {changes, at};
    }
  };
  offer(best.changes);
  std::vector<int> step(figures, -side);
  for (std::size_t k = 0; k < figures;) {
    std::vector<double> changes;
    for (std::size_t f = 0; f < figures; ++f) changes.push_back(reach[f] * step[f] / side);
    offer(changes);
    for (k = 0; k < figures && ++step[k] > side; ++k) step[k] = -side;  // the next place of the grid
  }
  return best;
}

Chance chance_of(std::span<const Mode> heard, const NuCurves& curves, const CalibrateOptions& options,
                 std::size_t matches) {
  constexpr int kLists = 100, kRatios = 12;
  constexpr double kMinShift_cents = 50, kMaxShift_cents = 300, kTuningStep_cents = 5;
  std::vector<std::vector<double>> baked;
  for (int k = 0; k < kRatios; ++k) {
    const double share = k / (kRatios - 1.0);
    baked.push_back(curves.at((1 - share) * curves.lowest() + share * curves.highest()));
  }
  std::minstd_rand random(1);  // NOLINT(bugprone-random-generator-seed): the figure repeats
  const auto uniform = [&random] { return static_cast<double>(random()) / static_cast<double>(random.max()); };
  Chance chance;
  for (int list = 0; list < kLists; ++list) {
    std::vector<double> shifted;
    for (const Mode& mode : heard) {
      const double shift = kMinShift_cents + (kMaxShift_cents - kMinShift_cents) * uniform();
      shifted.push_back(mode.frequency_hz * std::exp2((uniform() < 0.5 ? -shift : shift) / 1200));
    }
    std::ranges::sort(shifted);
    double least = INFINITY;
    std::size_t found = 0;
    for (const std::vector<double>& frequencies : baked) {
      for (double tuning = -options.max_tuning_cents; tuning <= options.max_tuning_cents; tuning += kTuningStep_cents) {
        const double square = mean_square_cents(shifted, frequencies, tuning, options.tolerance_cents);
        if (!(square < least)) continue;
        least = square;
        found = count_matches(shifted, frequencies, tuning, options.tolerance_cents);
      }
    }
    chance.matches += static_cast<double>(found) / kLists;
    chance.share += found >= matches ? 1.0 / kLists : 0;
  }
  return chance;
}

std::vector<Mode> as_recorded(std::span<const Mode> recording, const modal::Bank& bank, const Calibration& calibration,
                              const CalibrateOptions& options) {
  std::vector<Mode> modes;
  const double tuning = std::exp2(calibration.tuning_cents / 1200);
  for (const Match& match : calibration.matches) {
    const double lambda =
        tuning * tuning * modal::undamped_lambda({bank.frequency_hz[match.baked], bank.decay_per_s[match.baked]});
    const double frequency_hz = modal::rad_per_s_to_hz(std::sqrt(lambda));
    const modal::DampedMode baked =
        modal::with_decay(lambda, fitted_loss(calibration, bank, match.baked, frequency_hz).total_per_s());
    const auto nearest = std::ranges::min_element(
        recording, {}, [&](const Mode& mode) { return std::abs(mode.frequency_hz - baked.frequency_hz); });
    if (nearest == recording.end()) continue;
    if (std::abs(cents_between(nearest->frequency_hz, baked.frequency_hz)) > options.tolerance_cents) continue;
    Mode mode = *nearest;
    mode.frequency_hz = baked.frequency_hz;
    mode.decay_per_s = baked.decay_per_s;
    modes.push_back(mode);
  }
  return modes;
}

std::vector<double> spectrum_db(std::span<const double> samples, double sample_rate_hz, double low_hz, double high_hz,
                                std::size_t points) {
  std::size_t size = 1;
  while (size < 2 * samples.size()) size *= 2;
  std::vector<double> padded(size);
  for (std::size_t n = 0; n < samples.size(); ++n) {  // half a Hann window, falling: the blow is at the beginning
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
