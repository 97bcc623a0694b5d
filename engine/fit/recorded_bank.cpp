#include "engine/fit/recorded_bank.h"

#include "engine/modal/damping.h"
#include "engine/modal/hearing/contact_pulse.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/mode_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

// Calibration in three steps: the common factor between recorded and baked frequencies, the pairs that agree after it,
// and alpha and beta from the decays of the pairs by weighted least squares, repeated while the weights of outliers
// fall.
namespace ringdown::fit {
namespace {

double cents(double ratio) { return 1200 * std::log2(ratio); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The bank's modes by frequency.
struct Sorted {
  std::vector<std::size_t> order;
  std::vector<double> frequency_hz;

  explicit Sorted(const modal::Bank& bank) : order(bank.mode_count()) {
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, {}, [&](std::size_t m) { return bank.frequency_hz[m]; });
    for (const std::size_t m : order) frequency_hz.push_back(bank.frequency_hz[m]);
  }
  [[nodiscard]] std::size_t nearest(double frequency) const {
    const auto above = std::ranges::lower_bound(frequency_hz, frequency);
    if (above == frequency_hz.begin()) return 0;
    if (above == frequency_hz.end()) return frequency_hz.size() - 1;
    const bool lower = frequency * frequency < *above * *(above - 1);
    return static_cast<std::size_t>(above - frequency_hz.begin()) - (lower ? 1 : 0);
  }
};

// Assigns each recorded mode to the nearest baked mode; each baked mode keeps the nearest recorded one.
std::vector<Match> match(std::span<const Mode> recorded, const Sorted& baked, double tuning, double tolerance) {
  std::vector<Match> best(baked.order.size(), {recorded.size(), 0, tolerance});
  for (std::size_t r = 0; r < recorded.size(); ++r) {
    const double frequency = recorded[r].frequency_hz / std::exp2(tuning / 1200);
    const std::size_t b = baked.nearest(frequency);
    const double off = cents(frequency / baked.frequency_hz[b]);
    if (std::abs(off) < std::abs(best[b].off_cents)) best[b] = {r, baked.order[b], off};
  }
  std::erase_if(best, [&](const Match& m) { return m.recorded == recorded.size(); });
  return best;
}

double score(const std::vector<Match>& matches, double tolerance) {
  double sum = 0;
  for (const Match& m : matches) sum += 1 - std::pow(m.off_cents / tolerance, 2);
  return sum;
}

// Finds the tuning with the most and closest matches, then refines it. In a dense bank some mode lies near every
// frequency, so only a narrow tolerance shows the right tuning; of equally good tunings the smallest is chosen.
double find_tuning(std::span<const Mode> recorded, const Sorted& baked, const CalibrateOptions& options) {
  double best = options.around_cents, best_score = 0;
  const double narrow = std::min(8.0, options.tolerance_cents);
  for (double tuning = 0; tuning <= options.max_tuning_cents; ++tuning) {
    for (const double sign : {1.0, -1.0}) {
      const double candidate = options.around_cents + sign * tuning;
      const double s = score(match(recorded, baked, candidate, narrow), narrow);
      if (s > 1.001 * best_score) best = candidate, best_score = s;
    }
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<double> offs;
    for (const Match& m : match(recorded, baked, best, narrow)) offs.push_back(m.off_cents);
    if (!offs.empty()) best += median(std::move(offs));
  }
  return best;
}

struct Point {
  double lambda, decay, weight;
};

// Minimises the sum of (d - alpha/2 - beta lambda/2)^2 weight, with alpha and beta at least 0.
modal::RayleighDamping solve(const std::vector<Point>& points) {
  double w = 0, wl = 0, wll = 0, wd = 0, wld = 0;
  for (const Point& p : points) {
    w += p.weight, wl += p.weight * p.lambda, wll += p.weight * p.lambda * p.lambda;
    wd += p.weight * p.decay, wld += p.weight * p.lambda * p.decay;
  }
  const double determinant = w * wll - wl * wl;
  if (determinant > 1e-9 * w * wll) {
    const double alpha = 2 * (wll * wd - wl * wld) / determinant, beta = 2 * (w * wld - wl * wd) / determinant;
    if (alpha >= 0 && beta >= 0) return {alpha, beta};
  }
  // Otherwise either alpha or beta is 0, whichever fits better.
  const double gain_of_alpha = wd * wd / w, gain_of_beta = wld * wld / wll;
  return gain_of_alpha > gain_of_beta ? modal::RayleighDamping{2 * wd / w, 0}
                                      : modal::RayleighDamping{0, 2 * wld / wll};
}

double fitted(const modal::RayleighDamping& damping, double lambda) {
  return 0.5 * (damping.alpha_per_s + damping.beta_s * lambda);
}

}  // namespace

std::size_t Calibration::used() const {
  return static_cast<std::size_t>(std::ranges::count(matches, true, &Match::used));
}

// Iteratively reweighted least squares with Tukey's biweight: a mode counts less the further its decay lies from the
// law fitted before, in units of the spread of all modes (the median of the absolute deviations, scaled to a standard
// deviation), and not at all beyond 4.685 units. A mode that was matched wrongly, or damped by the hand that held the
// object, therefore does not distort alpha and beta. Deviations are those of the decays' logarithms.
Result<Calibration> calibrate(std::span<const Mode> recorded, const modal::Bank& bank,
                              const CalibrateOptions& options) {
  const Sorted baked(bank);
  Calibration result;
  result.tuning_cents = find_tuning(recorded, baked, options);
  result.matches = match(recorded, baked, result.tuning_cents, options.tolerance_cents);
  if (result.matches.size() < kMinMatches) {
    return fail(ErrorKind::bad_input, "only " + std::to_string(result.matches.size()) + " of the recording's " +
                                          std::to_string(recorded.size()) + " modes match one of the bank's, and " +
                                          std::to_string(kMinMatches) +
                                          " are needed: is it the same object? --tolerance takes more");
  }
  // Relative errors of the estimate, and of the law, which is accurate to about 5 % at best.
  constexpr double kOfTheLaw = 0.05, kMinSpread = 0.02, kBiweight = 4.685, kFromMad = 1.4826;
  constexpr int kRounds = 30;
  std::vector<double> off(result.matches.size(), 0), tukey(result.matches.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < result.matches.size(); ++i) {
      const Mode& mode = recorded[result.matches[i].recorded];
      // The weight follows from the fitted decay. With the measured one, modes measured too long would count too much.
      const double lambda = modal::undamped_lambda({mode.frequency_hz, mode.decay_per_s});
      const double expected = round == 0 ? mode.decay_per_s : fitted(result.damping, lambda);
      const double error = std::hypot(mode.decay_error_per_s, kOfTheLaw * expected);
      points.push_back({lambda, mode.decay_per_s, tukey[i] / (error * error)});
    }
    result.damping = solve(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      off[i] = std::log(points[i].decay / fitted(result.damping, points[i].lambda));
    }
    std::vector<double> sizes;
    for (const double o : off) sizes.push_back(std::abs(o));
    const double spread = std::max(kFromMad * median(std::move(sizes)), kMinSpread);
    for (std::size_t i = 0; i < off.size(); ++i) {
      const double x = off[i] / (kBiweight * spread);
      tukey[i] = std::abs(x) < 1 ? std::pow(1 - x * x, 2) : 0;
    }
  }
  double square = 0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    result.matches[i].used = tukey[i] > 0;
    if (tukey[i] > 0) square += off[i] * off[i];
  }
  result.spread = std::expm1(std::sqrt(square / static_cast<double>(std::max<std::size_t>(result.used(), 1))));
  return result;
}

modal::Bank with_damping(const modal::Bank& bank, const modal::RayleighDamping& damping) {
  modal::Bank result = bank;
  result.losses.clear();
  std::vector<std::size_t> ringing;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const modal::DampedMode mode =
        modal::damp(modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}), damping);
    result.frequency_hz[m] = mode.frequency_hz;
    result.decay_per_s[m] = mode.decay_per_s;
    if (mode.frequency_hz > 0) ringing.push_back(m);
  }
  modal::take_modes(result, ringing);
  if (result.material) {
    result.material->damping = damping;
    result.material->loss_factors.clear();
  }
  return result;
}

double peak_pressure_pa(const modal::Bank& bank, double impulse_ns) {
  constexpr double kRate_hz = 48000;
  constexpr std::size_t kFrames = 24000;
  Vec3 along;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const modal::Vec3f& shape = bank.shape(m, 0);
    const Vec3 here{shape[0], shape[1], shape[2]};
    if (length(here) > length(along)) along = here;
  }
  if (length(along) == 0) return 0;
  const modal::Loudness loudness(bank);
  std::vector<double> sound(kFrames, 0.0);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const modal::Vec3f& shape = bank.shape(m, 0);
    const double omega = modal::hz_to_rad_per_s(bank.frequency_hz[m]);
    const double velocity = impulse_ns / length(along) * dot(along, Vec3{shape[0], shape[1], shape[2]});
    const double pressure_pa = velocity * loudness.pressure_pa(bank, m, {}, bank.frequency_hz[m]);
    const std::complex<double> step = std::exp(std::complex<double>(-bank.decay_per_s[m], omega) / kRate_hz);
    std::complex<double> z = pressure_pa;
    for (double& sample : sound) {
      sample += z.imag();
      z *= step;
    }
  }
  double peak = 0;
  for (const double sample : sound) peak = std::max(peak, std::abs(sample));
  return peak * bank.gain;
}

modal::Bank to_bank(std::span<const Mode> modes, const Blow& blow, double loudness, const std::string& name,
                    std::span<const Mode> burst) {
  constexpr double kMinPulse = 0.1;
  std::vector<Mode> ordered(modes.begin(), modes.end());
  std::ranges::sort(ordered, std::greater{}, [](const Mode& m) { return m.amplitude * m.amplitude / m.decay_per_s; });
  ordered.insert(ordered.end(), burst.begin(), burst.end());
  modal::Bank bank{.name = name, .positions = {{0, 0, 0}}};
  bank.provenance.generator = "ringdown " RINGDOWN_VERSION ", from a recording";
  const double per_impulse = 1 / dot(blow.impulse_ns, blow.impulse_ns);
  for (const Mode& mode : ordered) {
    bank.frequency_hz.push_back(mode.frequency_hz);
    bank.decay_per_s.push_back(mode.decay_per_s);
    bank.frequency_error.push_back(mode.frequency_error_hz / mode.frequency_hz);
    const double pulse = modal::pulse_spectrum(mode.frequency_hz, blow.contact_time_s);
    const double answer = mode.amplitude / (loudness * modal::hz_to_rad_per_s(mode.frequency_hz) *
                                            std::copysign(std::max(std::abs(pulse), kMinPulse), pulse));
    const Vec3 shape =
        std::copysign(answer * per_impulse, mode.phase_rad == 0 ? 1 : std::cos(mode.phase_rad) * answer) *
        blow.impulse_ns;
    bank.shapes.push_back({static_cast<float>(shape.x), static_cast<float>(shape.y), static_cast<float>(shape.z)});
  }
  bank.provenance.peak_pa = peak_pressure_pa(bank, modal::kPeakBlow_ns);
  return bank;
}

}  // namespace ringdown::fit
