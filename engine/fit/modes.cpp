#include "engine/fit/modes.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/fit/sinusoids.h"
#include "engine/fit/band_powers.h"
#include "engine/fit/extent.h"
#include "engine/fit/poles.h"
#include "engine/fit/pursuit.h"
#include "engine/fit/subband.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

// The search, from long modes to short ones
//
// A pass analyses the beginning of the remaining sound: first all of it, then a quarter, a sixteenth and so on. The
// pass cuts the band of frequencies into narrow bands of a few hundred samples each (subband.h), finds and refines the
// poles in every band (poles.h), and keeps those that decay in about the length of the pass: slower ones were found
// before, faster ones wait for a shorter pass. Neighbouring bands overlap, so a mode found in two of them is merged
// into one. Then the amplitudes of all modes so far are fitted together, and their sum is subtracted for the next pass.
// If the remainder of all passes still contains a blow, its modes are too short for passes, and are pursued one by one
// (pursuit.h).
namespace ringdown::fit {
namespace {

constexpr double kSamplesOfBand = 400;  // approximate number of samples of each band in a pass
constexpr double kPassRatio = 4;        // ratio of one pass's length to the next one's
constexpr double kMinPass_s = 0.02;
constexpr double kMaxDecayOfPass = 12;  // decay times length; above, the mode waits for a shorter pass
constexpr double kMinDecayOfPass = 5;   // decay times length of the last pass; below, that pass would have found it
constexpr Eigen::Index kMaxPoles = 44;  // poles of a band
constexpr double kOverlap = 0.04;       // share of the core, on either side
constexpr double kMinCycles = 1.5;      // frequency over decay; below, the sound is a thud, not a tone
constexpr double kMinDecay = 3;         // decay over its standard error; below, the sound may be hum
constexpr double kUnresolved = 0.02;    // modes nearer than this over the length are one mode, found twice
constexpr double kRemains = 0.25;       // remains of an earlier pass's mode lie nearer to it than this over the length
constexpr double kSilence_s = 0.02;     // silence before the blow that is long enough to measure the noise
constexpr double kTrace = 0.1;          // largest amplitude of remains, relative to their mode

struct Candidate {
  Mode mode;
  std::size_t band;
  bool accepted;  // false: a component of the sound, but not a mode of this pass
};

struct Pass {
  SubbandFilter filter;
  double rate_hz, length_s;
  double low_hz, high_hz;
  double slowest_per_s;

  Pass(double rate, double length, double low, double high, bool first)
      : filter(static_cast<std::size_t>(std::max(1.0, std::round(rate * length / kSamplesOfBand)))),
        rate_hz(rate),
        length_s(length),
        low_hz(low),
        high_hz(high),
        slowest_per_s(first ? 0 : kMinDecayOfPass / (kPassRatio * length)) {}
  [[nodiscard]] double band_rate_hz() const { return rate_hz / static_cast<double>(filter.step()); }
  [[nodiscard]] double width_hz() const { return SubbandFilter::kCore * band_rate_hz(); }
  [[nodiscard]] std::size_t bands() const {
    return static_cast<std::size_t>(std::ceil((high_hz - low_hz) / width_hz()));
  }
};

// Returns true if the mode decays, differs from a steady tone, rings for more than a cycle, and lasts for much of the
// pass.
bool is_mode_of(const Pass& pass, const Mode& mode) {
  return mode.decay_per_s > kMinDecay * mode.decay_error_per_s && mode.decay_per_s * pass.length_s < kMaxDecayOfPass &&
         mode.decay_per_s > pass.slowest_per_s && mode.frequency_hz > kMinCycles * mode.decay_per_s &&
         mode.frequency_hz >= pass.low_hz && mode.frequency_hz <= pass.high_hz;
}

double centre_hz(const Pass& pass, std::size_t band) {
  return pass.low_hz + (static_cast<double>(band) + 0.5) * pass.width_hz();
}

std::vector<Candidate> search_band(const Eigen::VectorXcd& samples, const Pass& pass, std::size_t band) {
  std::vector<Candidate> found;
  for (const Term& term : refine(samples, find_poles(samples, kMaxPoles))) {
    const double rate = pass.band_rate_hz(), offset = term.pole.imag() * rate / (2 * std::numbers::pi);
    const double decay = -term.pole.real() * rate, delay = 0.5 * static_cast<double>(pass.filter.taps()) / pass.rate_hz;
    const Mode mode{.frequency_hz = centre_hz(pass, band) + offset,
                    .decay_per_s = decay,
                    .amplitude = 2 * std::abs(term.amplitude) * std::exp(decay * delay),
                    .frequency_error_hz = term.pole_error * rate / (2 * std::numbers::pi),
                    .decay_error_per_s = term.pole_error * rate,
                    .amplitude_error = 1 / term.significance};
    if (std::abs(offset) <= (0.5 + kOverlap) * pass.width_hz()) found.push_back({mode, band, is_mode_of(pass, mode)});
  }
  return found;
}

// Calls work(0) ... work(count - 1), shared out to threads as they become free.
template <class Work>
void for_all(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  in_parallel(std::min<int>(thread_count(threads), static_cast<int>(count)), [&](int) {
    for (std::size_t n; (n = next++) < count;) work(n);
  });
}

// Finds candidates in all bands but quiet ones. A band below the floor is quiet: even if all its sound were one mode,
// the mode would be dropped. Most often such a band holds only what the filter leaves of its neighbours.
std::vector<Candidate> search(std::span<const double> signal, const Pass& pass, const Options& options) {
  const dense::BlasThreads one(1);
  const Eigen::MatrixXcd samples = pass.filter.take(signal, centre_hz(pass, 0) / pass.rate_hz, pass.bands());
  std::vector<std::vector<Candidate>> found(pass.bands());
  if (samples.cols() == 0) return {};
  const Eigen::VectorXd peaks = samples.cwiseAbs().rowwise().maxCoeff();
  constexpr double kBelowFloor_db = 12;
  const double quietest_db = options.quietest_band_db.value_or(options.floor_db + kBelowFloor_db);
  const double min = std::pow(10, -quietest_db / 20) * peaks.maxCoeff();
  for_all(found.size(), options.threads, [&](std::size_t band) {
    const auto row = static_cast<Eigen::Index>(band);
    if (peaks[row] > min) found[band] = search_band(samples.row(row).transpose(), pass, band);
  });
  std::vector<Candidate> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

// Neighbouring bands overlap. A mode that both found becomes one mode, with the better estimate.
std::vector<Candidate> without_doubles(std::vector<Candidate> candidates, double length_s) {
  std::ranges::sort(candidates, {}, [](const Candidate& c) { return c.mode.frequency_hz; });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    const auto same = [&](const Candidate& k) {
      const double apart = c.mode.frequency_hz - k.mode.frequency_hz;
      const double error = c.mode.frequency_error_hz + k.mode.frequency_error_hz;
      return k.band != c.band && apart < std::max(5 * error, kUnresolved / length_s);
    };
    const auto twin = std::find_if(kept.end() - std::min<std::ptrdiff_t>(4, std::ssize(kept)), kept.end(), same);
    if (twin == kept.end()) {
      kept.push_back(c);
    } else if (c.mode.frequency_error_hz < twin->mode.frequency_error_hz) {
      *twin = c;
    }
  }
  return kept;
}

double energy(const Mode& mode) { return mode.amplitude * mode.amplitude / mode.decay_per_s; }

// Drops modes below the options' floor and beyond their maximum number. Returns true when any was dropped.
bool prune(std::vector<Mode>& modes, const Options& options) {
  const std::size_t before = modes.size();
  double loudest = 0;
  for (const Mode& mode : modes) loudest = std::max(loudest, mode.amplitude);
  const double min = loudest * std::pow(10, -options.floor_db / 20);
  std::erase_if(modes, [&](const Mode& mode) { return mode.amplitude < min; });
  std::ranges::sort(modes, std::greater{}, energy);
  modes.resize(std::min(modes.size(), options.max_modes));
  std::ranges::sort(modes, {}, &Mode::frequency_hz);
  return modes.size() < before;
}

std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
  std::vector<double> result(a.begin(), a.end());
  for (std::size_t n = 0; n < result.size(); ++n) result[n] -= b[n];
  return result;
}

double square_sum(std::span<const double> x) { return std::inner_product(x.begin(), x.end(), x.begin(), 0.0); }

// Fits the amplitudes of all modes so far, together with an offset and with all other components that a pass of this
// length has found. A component of the sound that is not in the sum would bend the amplitudes of its neighbours. A
// component that the pass cannot tell from a mode is left out, because the fit would split the mode between the two
// with arbitrary amplitudes.
void fit_amplitudes_beside(std::span<const double> sound, double rate, std::vector<Mode>& modes,
                           const std::vector<Candidate>& found = {}, double length_s = 0) {
  std::vector<Mode> all = modes;
  all.push_back({});
  for (const Candidate& c : found) {
    const auto near = [&](const Mode& mode) {
      return std::abs(mode.frequency_hz - c.mode.frequency_hz) < 1 / length_s;
    };
    if (!c.accepted && std::ranges::none_of(modes, near)) all.push_back(c.mode);
  }
  fit_amplitudes(sound, rate, all);
  std::copy_n(all.begin(), modes.size(), modes.begin());
}

// Returns true when a mode is only the remainder of a mode that an earlier pass found. Subtracting an estimate leaves a
// weak remainder at its pitch, or a weak and broad one nearby, where a real mode would be masked.
bool is_remains(const Mode& mode, std::span<const Mode> known, double length_s) {
  return std::ranges::any_of(known, [&](const Mode& k) {
    const double apart = std::abs(mode.frequency_hz - k.frequency_hz);
    const bool same = apart < kRemains / length_s && std::abs(mode.decay_per_s - k.decay_per_s) < 0.5 * k.decay_per_s;
    const bool beside = apart < 1 / length_s + modal::rad_per_s_to_hz(2 * mode.decay_per_s);
    return same || (beside && mode.amplitude < kTrace * k.amplitude);
  });
}

std::vector<Mode> search_all(std::span<const double> sound, double rate, const Options& options) {
  const double high = std::min(options.high_hz, 0.49 * rate), whole = static_cast<double>(sound.size()) / rate;
  std::vector<Mode> modes;
  std::vector<double> left(sound.begin(), sound.end());
  for (double length = whole; length >= kMinPass_s; length /= kPassRatio) {
    const Pass pass(rate, length, options.low_hz, high, length == whole);
    const auto part = std::span(left).first(static_cast<std::size_t>(length * rate));
    const std::vector<Candidate> found = without_doubles(search(part, pass, options), length);
    std::vector<Mode> fresh;
    for (const Candidate& c : found) {
      if (c.accepted && !is_remains(c.mode, modes, length)) fresh.push_back(c.mode);
    }
    if (fresh.empty()) continue;
    modes.insert(modes.end(), fresh.begin(), fresh.end());
    fit_amplitudes_beside(sound, rate, modes, found, length);
    prune(modes, {.floor_db = options.floor_db + 20, .max_modes = kMaxModes});
    left = difference(sound, synthesise(modes, rate, sound.size()));
  }
  return modes;
}

double mean_square(std::span<const double> x) {
  return square_sum(x) / static_cast<double>(std::max<std::size_t>(x.size(), 1));
}

// Adds short modes if the first kPursuit_s of the remaining sound are a blow: much louder than the sound that follows,
// and a considerable part of the whole sound. `noise` is the mean square of the samples without the sound, if known.
void add_short_modes(std::span<const double> sound, double rate, const Options& options, std::optional<double> noise,
                     std::vector<Mode>& modes) {
  constexpr double kStands = 4, kPart = 0.05;  // ratios of energy
  const std::vector<double> left = difference(sound, synthesise(modes, rate, sound.size()));
  const auto head = std::min(left.size(), static_cast<std::size_t>(kPursuit_s * rate));
  const std::span<const double> beginning = std::span(left).first(head);
  const double tail = left.size() > 2 * head ? mean_square(std::span(left).subspan(left.size() - head)) : 0;
  const double quiet = std::max(noise.value_or(0), noise ? 0 : tail);
  if (mean_square(beginning) < kStands * std::max(quiet, tail)) return;
  if (square_sum(beginning) < kPart * square_sum(sound.first(head))) return;
  const std::vector<Mode> found =
      pursue(beginning, rate, {.low_hz = options.low_hz, .high_hz = options.high_hz, .noise = std::max(quiet, tail)});
  if (found.empty()) return;
  modes.insert(modes.end(), found.begin(), found.end());
  fit_amplitudes_beside(sound, rate, modes);
}

Result<void> check(std::span<const double> samples, double rate, const Options& options) {
  if (!(rate >= kMinRate_hz && rate <= kMaxRate_hz)) {
    return fail(ErrorKind::bad_input, "a sample rate of {} Hz is not between 8 and 768 kHz", rate);
  }
  if (static_cast<double>(samples.size()) < kMinLength_s * rate)
    return fail(ErrorKind::bad_input, "it is shorter than 50 ms");
  if (!std::ranges::all_of(samples, [](double x) { return std::isfinite(x); })) {
    return fail(ErrorKind::bad_input, "it has a sample that is not a number");
  }
  if (!(options.low_hz >= 1 && options.high_hz > options.low_hz && options.low_hz < 0.49 * rate)) {
    return fail(ErrorKind::bad_input,
                "the band must begin at 1 Hz or above, end above its beginning, and begin below half the sample rate");
  }
  if (!(options.floor_db > 0) || options.max_modes == 0 || options.max_modes > kMaxModes) {
    return fail(ErrorKind::bad_input, "the floor must be above 0 dB, and the number of modes from 1 to {}", kMaxModes);
  }
  if (options.from_s &&
      !(*options.from_s >= 0 && *options.from_s * rate + kMinLength_s * rate <= std::ssize(samples))) {
    return fail(ErrorKind::bad_input, "less than 50 ms of sound follow the time at which the fit should begin");
  }
  return {};
}

}  // namespace

Result<Fit> fit_modes(std::span<const double> samples, double sample_rate_hz, const Options& options) {
  if (auto good = check(samples, sample_rate_hz, options); !good) return fail(good);
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  std::vector<double> centred(samples.begin(), samples.end());
  for (double& sample : centred) sample -= mean;
  std::optional<std::size_t> from;
  if (options.from_s) from = static_cast<std::size_t>(std::round(*options.from_s * sample_rate_hz));
  const std::optional<Extent> extent = find_extent(centred, sample_rate_hz, from);
  if (!extent) return Fit{};
  const auto max = static_cast<std::size_t>(kMaxLength_s * sample_rate_hz);
  const auto sound = std::span(centred).subspan(extent->start, std::min(max, extent->end - extent->start));

  Fit fit{.modes = search_all(sound, sample_rate_hz, options), .clipped = extent->clipped};
  const auto before = std::span(centred)
                          .first(extent->onset)
                          .last(std::min(extent->onset, static_cast<std::size_t>(kMaxSilence_s * sample_rate_hz)));
  const bool silence_before = static_cast<double>(before.size()) > kSilence_s * sample_rate_hz;
  const std::optional<double> noise = silence_before ? std::optional(mean_square(before)) : std::nullopt;
  add_short_modes(sound, sample_rate_hz, options, noise, fit.modes);
  if (prune(fit.modes, options)) fit_amplitudes_beside(sound, sample_rate_hz, fit.modes);
  const auto left = difference(sound, synthesise(fit.modes, sample_rate_hz, sound.size()));
  fit.explained = 1 - square_sum(left) / square_sum(sound);
  const double of_noise = std::min(noise.value_or(0) * static_cast<double>(sound.size()), 0.99 * square_sum(sound));
  fit.of_blow = 1 - std::max(square_sum(left) - of_noise, 0.0) / (square_sum(sound) - of_noise);
  fit.onset_s = static_cast<double>(extent->onset) / sample_rate_hz;
  fit.start_s = static_cast<double>(extent->start) / sample_rate_hz;
  fit.end_s = fit.start_s + static_cast<double>(sound.size()) / sample_rate_hz;
  move_time(fit.modes, fit.onset_s - fit.start_s);
  return fit;
}

}  // namespace ringdown::fit
