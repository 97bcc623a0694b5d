#include "engine/fit/recorded_bank.h"

#include "engine/base/version.h"
#include "engine/modal/damping.h"
#include "engine/modal/hearing/contact_pulse.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_choice.h"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

// Calibration in three steps: the common factor between recorded and baked frequencies, the pairs that agree after it,
// and loss factors from the decays of the pairs by weighted least squares, repeated while the weights of outliers fall.
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

// Finds the tuning with the most and closest matches, then refines it by medians, and last on a fixed grid, whose best
// tuning is the same wherever the search began. In a dense bank some mode lies near every frequency, so only a narrow
// tolerance shows the right tuning; of equally good tunings the smallest is chosen.
double find_tuning(std::span<const Mode> recorded, const Sorted& baked, const CalibrateOptions& options) {
  double best = options.around_cents, best_score = 0;
  const double narrow = std::min(8.0, options.tolerance_cents);
  for (double tuning = 0; tuning <= options.max_tuning_cents; ++tuning) {
    for (const double sign : {1.0, -1.0}) {
      const double candidate = options.around_cents + sign * tuning;
      const double s = score(match(recorded, baked, candidate, narrow), narrow);
      if (s > 1.001 * best_score) {
        best = candidate;
        best_score = s;
      }
    }
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<double> offs;
    for (const Match& m : match(recorded, baked, best, narrow)) offs.push_back(m.off_cents);
    if (!offs.empty()) best += median(std::move(offs));
  }
  constexpr double kFine = 0.05;
  constexpr int kReach = 40;  // steps to either side
  const auto middle = static_cast<int>(std::lround(best / kFine));
  best_score = 0;
  for (int step = middle - kReach; step <= middle + kReach; ++step) {
    const double s = score(match(recorded, baked, kFine * step, narrow), narrow);
    if (s <= best_score) continue;
    best = kFine * step;
    best_score = s;
  }
  return best;
}

// Returns the losses of a mode to air, heat and supports [1/s]. Rayleigh's alpha is no such loss: it is fitted anew.
modal::ModeLoss other_losses(const modal::Bank& bank, std::size_t m) {
  if (bank.losses.empty()) return {};
  modal::ModeLoss loss = bank.losses[m];
  loss.material_per_s = 0;
  if (!bank.material || bank.material->loss_factors.empty()) loss.support_per_s = 0;
  return loss;
}

// The logarithm of a measured loss factor, and what it is worth.
struct Point {
  double log_f, log_eta, error, weight;
};

// log eta at one to three frequencies, straight between them.
struct Law {
  std::vector<double> log_f, log_eta, error;

  // The shares of the frequencies at a point: they sum to 1, and at most two are not 0.
  [[nodiscard]] Eigen::Vector3d shares(double at) const {
    const auto above = std::ranges::upper_bound(log_f, at) - log_f.begin();
    if (above == 0) return Eigen::Vector3d::Unit(0);
    if (above == std::ssize(log_f)) return Eigen::Vector3d::Unit(above - 1);
    const double share = (at - log_f[above - 1]) / (log_f[above] - log_f[above - 1]);
    return (1 - share) * Eigen::Vector3d::Unit(above - 1) + share * Eigen::Vector3d::Unit(above);
  }
  [[nodiscard]] double at(double place) const {
    const Eigen::Vector3d shares = this->shares(place);
    double sum = 0;
    for (std::size_t k = 0; k < log_f.size(); ++k) sum += shares[static_cast<Eigen::Index>(k)] * log_eta[k];
    return sum;
  }
};

// Equal steps in pitch from the lowest point to the highest; the middle alone where there is one.
Law law_of(const std::vector<Point>& points, int count) {
  const auto [low, high] = std::ranges::minmax(points, {}, &Point::log_f);
  Law law;
  for (int k = 0; k < count; ++k)
    law.log_f.push_back(low.log_f + (high.log_f - low.log_f) * (count == 1 ? 0.5 : k / (count - 1.0)));
  law.log_eta.resize(law.log_f.size());
  law.error.resize(law.log_f.size());
  return law;
}

// Weighted least squares; false where the points do not determine it.
bool solve(const std::vector<Point>& points, Law& law) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index k = std::ssize(law.log_f); k < 3; ++k) normal(k, k) = 1;  // frequencies that there are not
  for (const Point& p : points) {
    const Eigen::Vector3d shares = law.shares(p.log_f);
    const double weight = p.weight / (p.error * p.error);
    normal += weight * shares * shares.transpose();
    right += weight * p.log_eta * shares;
  }
  if (!(normal.diagonal().minCoeff() > 0)) return false;
  const Eigen::Matrix3d covariance = normal.inverse();
  const Eigen::Vector3d solved = covariance * right;
  if (!solved.allFinite()) return false;
  for (std::size_t k = 0; k < law.log_f.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    law.log_eta[k] = solved[row];
    law.error[k] = std::sqrt(std::max(covariance(row, row), 0.0));
  }
  return true;
}

double median_off(const std::vector<Point>& points, const Law& law) {
  std::vector<double> sizes;
  for (const Point& p : points) sizes.push_back(std::abs(p.log_eta - law.at(p.log_f)));
  return median(std::move(sizes));
}

// Iteratively reweighted least squares with Tukey's biweight: a mode counts less the further it lies from the law
// fitted before, in units of the spread of all modes (the median of the absolute deviations, scaled to a standard
// deviation), and not at all beyond 4.685 units. A mode that was matched wrongly, or damped by the hand that held the
// object, therefore does not distort the loss factors. Returns the standard deviation of those that count.
std::optional<double> fit_law(std::vector<Point>& points, Law& law) {
  constexpr double kMinSpread = 0.02, kBiweight = 4.685, kFromMad = 1.4826;
  constexpr int kRounds = 30;
  for (int round = 0; round < kRounds; ++round) {
    if (!solve(points, law)) return std::nullopt;
    const double spread = std::max(kFromMad * median_off(points, law), kMinSpread);
    for (Point& p : points) {
      const double x = (p.log_eta - law.at(p.log_f)) / (kBiweight * spread);
      p.weight = std::abs(x) < 1 ? std::pow(1 - x * x, 2) : 0;
    }
  }
  double square = 0, count = 0;
  for (const Point& p : points) {
    if (p.weight > 0) {
      square += std::pow(p.log_eta - law.at(p.log_f), 2);
      ++count;
    }
  }
  return std::sqrt(square / std::max(count, 1.0));
}

// Akaike's criterion with its correction for few points; infinite where they are too few.
double criterion(double spread, double points, double figures) {
  constexpr double kMinSpread = 0.01;
  if (points < figures + 3) return std::numeric_limits<double>::infinity();
  return 2 * points * std::log(std::max(spread, kMinSpread)) + 2 * figures * points / (points - figures - 1);
}

}  // namespace

std::size_t Calibration::used() const {
  return static_cast<std::size_t>(std::ranges::count(matches, true, &Match::used));
}

std::string Calibration::text() const {
  std::string text;
  for (std::size_t k = 0; k < loss_factors.size(); ++k) {
    text += formatted("{}{:.3g} +- {:.2g} % at {:.4g} Hz", k > 0 ? ", " : "", loss_factors[k].eta, 100 * loss_errors[k],
                      loss_factors[k].frequency_hz);
  }
  return text;
}

Result<Calibration> calibrate(std::span<const Mode> recorded, const modal::Bank& bank,
                              const CalibrateOptions& options) {
  const Sorted baked(bank);
  Calibration result;
  result.tuning_cents = find_tuning(recorded, baked, options);
  result.matches = match(recorded, baked, result.tuning_cents, options.tolerance_cents);
  if (result.matches.size() < kMinMatches) {
    return fail(ErrorKind::bad_input,
                "only {} of the recording's {} modes match one of the bank's, and {} are needed: check that it is the "
                "same object, or raise --tolerance",
                result.matches.size(), recorded.size(), kMinMatches);
  }
  // Relative errors of the estimate, and of the law, which is accurate to about 5 % at best. Where the others take all
  // but a fifth of a decay or more than that, a fifth is the material's, to within itself.
  constexpr double kOfTheLaw = 0.05, kMinShare = 0.2;
  std::vector<Point> points;
  for (const Match& pair : result.matches) {
    const Mode& mode = recorded[pair.recorded];
    const double others = other_losses(bank, pair.baked).total_per_s();
    const double material = std::max(mode.decay_per_s - others, kMinShare * mode.decay_per_s);
    const double omega = std::sqrt(modal::undamped_lambda({mode.frequency_hz, mode.decay_per_s}));
    const double share = modal::material_share(bank, pair.baked);
    double error = std::hypot(mode.decay_error_per_s, kOfTheLaw * mode.decay_per_s) / material;
    if (mode.decay_per_s - others < material) error += 1;
    points.push_back({std::log(modal::rad_per_s_to_hz(omega)), std::log(2 * material / (omega * share)), error, 1});
  }
  double best = std::numeric_limits<double>::infinity();
  for (int figures = 1; figures <= 3; ++figures) {
    Law law = law_of(points, figures);
    const auto spread = fit_law(points, law);
    if (!spread) break;
    const double score = criterion(*spread, static_cast<double>(points.size()), figures);
    if (figures > 1 && !(score < best)) continue;
    best = score;
    result.loss_factors.clear();
    for (std::size_t k = 0; k < law.log_f.size(); ++k)
      result.loss_factors.push_back({std::exp(law.log_f[k]), std::exp(law.log_eta[k])});
    result.loss_errors = law.error;
    result.spread = std::expm1(*spread);
    for (std::size_t i = 0; i < points.size(); ++i) result.matches[i].used = points[i].weight > 0;
  }
  return result;
}

modal::ModeLoss fitted_loss(const Calibration& calibration, const modal::Bank& bank, std::size_t baked,
                            double frequency_hz) {
  modal::ModeLoss loss = other_losses(bank, baked);
  loss.material_per_s = 0.5 * modal::hz_to_rad_per_s(frequency_hz) * modal::material_share(bank, baked) *
                        modal::loss_factor_at(calibration.loss_factors, frequency_hz);
  return loss;
}

modal::Bank with_losses(const modal::Bank& bank, const Calibration& calibration) {
  modal::Bank result = bank;
  result.losses.clear();
  std::vector<std::size_t> ringing;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double lambda = modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    const modal::ModeLoss loss = fitted_loss(calibration, bank, m, modal::rad_per_s_to_hz(std::sqrt(lambda)));
    const modal::DampedMode mode = modal::with_decay(lambda, loss.total_per_s());
    result.losses.push_back(loss);
    result.frequency_hz[m] = mode.frequency_hz;
    result.decay_per_s[m] = mode.decay_per_s;
    if (mode.frequency_hz > 0) ringing.push_back(m);
  }
  modal::take_modes(result, ringing);
  if (result.material) {
    result.material->damping = modal::fit_rayleigh_to_list(calibration.loss_factors);
    result.material->loss_factors = calibration.loss_factors;
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
  bank.provenance.generator = std::string("ringdown ") + kVersion + ", from a recording";
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
