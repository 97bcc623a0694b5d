#include "engine/bake/audibility.h"

#include "engine/materials/importance.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/hearing/masking.h"
#include "engine/modal/mode_choice.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>

// Two rounds of listening
//
// Every sample point is struck along its normal, and all modes are followed in time as straight lines in dB. In the
// first round every mode may mask: a mode survives if at one point it is above the floor and no louder mode hides it.
// In the second round only survivors may mask, which brings back what only a dropped mode hid. What the dropped modes
// would have added is then computed exactly, as the energy of their sum (energies()), and written into the bank.
namespace ringdown::bake {
namespace {

constexpr double kLoudest_db = 60;  // SPL, for the level-dependent slope
constexpr double kMinute_s = 60;    // what outlasts it is not waited for
constexpr Eigen::Index kRowsAtOnce = 256;
constexpr std::size_t kMaxStrikes = 2000;

double db(double power) { return 10 * std::log10(power); }

Eigen::Vector3d vector(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

// Area-weighted over the triangles at a point; zero where there is none.
std::vector<Eigen::Vector3d> outward_normals(const modal::Bank& bank) {
  std::vector<Eigen::Vector3d> normals(bank.point_count(), Eigen::Vector3d::Zero());
  for (const auto& triangle : bank.triangles) {
    const Eigen::Vector3d a = vector(bank.positions[triangle[0]]), b = vector(bank.positions[triangle[1]]),
                          c = vector(bank.positions[triangle[2]]);
    for (const std::uint32_t corner : triangle) normals[corner] += (b - a).cross(c - a);
  }
  for (Eigen::Vector3d& normal : normals) normal.normalize();
  return normals;
}

// g, M x the points that are struck. Where a bank has no triangles a strike is taken along the shape itself.
Eigen::MatrixXd strike_amplitudes(const modal::Bank& bank) {
  const std::vector<Eigen::Vector3d> normals = outward_normals(bank);
  const std::size_t stride = (bank.point_count() + kMaxStrikes - 1) / kMaxStrikes;
  Eigen::MatrixXd amplitudes(static_cast<Eigen::Index>(bank.mode_count()),
                             static_cast<Eigen::Index>((bank.point_count() + stride - 1) / stride));
  const modal::Loudness loudness(bank);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double f = bank.frequency_hz[m];
    const double gain = loudness.pressure_pa(bank, m, {}, f) * a_weighting(f) * hard_contact(f);
    for (std::size_t p = 0; p < bank.point_count(); p += stride) {
      const Eigen::Vector3d shape = vector(bank.shape(m, p));
      amplitudes(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(p / stride)) =
          gain * (normals[p].isZero() ? shape.norm() : shape.dot(normals[p]));
    }
  }
  return amplitudes;
}

// A mode's level at one point: `start` + `fall` t, the loudest starting at kLoudest_db.
struct Heard {
  double start_db, collected_db, fall_db_per_s, frequency_hz, bark;
};

std::vector<Heard> heard_at(const modal::Bank& bank, const Eigen::Ref<const Eigen::VectorXd>& amplitudes) {
  std::vector<Heard> heard;
  double loudest = -INFINITY, max_collected = -INFINITY;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double power = std::pow(amplitudes[static_cast<Eigen::Index>(m)], 2), decay = bank.decay_per_s[m];
    heard.push_back({db(power), db(power * collected_s(decay)), -20 * decay / std::numbers::ln10, bank.frequency_hz[m],
                     modal::bark(bank.frequency_hz[m])});
    loudest = std::max(loudest, heard.back().start_db);
    max_collected = std::max(max_collected, heard.back().collected_db);
  }
  if (std::isinf(loudest)) return {};  // a point where nothing moves
  for (Heard& mode : heard) {
    mode.start_db += kLoudest_db - loudest;
    mode.collected_db += kLoudest_db - max_collected;
  }
  return heard;
}

bool hides(const Heard& masker, const Heard& masked, double time_s) {
  const double level = masker.start_db + masker.fall_db_per_s * time_s;
  const double threshold = modal::masked_below_db(level, masker.frequency_hz, masker.bark, masked.bark);
  return masked.start_db + masked.fall_db_per_s * time_s < threshold;
}

bool is_heard(const std::vector<Heard>& modes, std::size_t m, const std::vector<bool>& may_mask, double floor_db) {
  const Heard& mode = modes[m];
  const double floor = kLoudest_db - floor_db;
  if (mode.start_db < floor && mode.collected_db < floor) return false;
  // Threshold and level are straight lines in time, so that it is enough to look at both ends.
  const double until_s = std::clamp((floor - mode.start_db) / std::min(mode.fall_db_per_s, -1e-9), 0.0, kMinute_s);
  for (std::size_t j = 0; j < modes.size(); ++j) {
    if (may_mask[j] && modes[j].start_db > mode.start_db + modal::kMinMaskingOffset_db && hides(modes[j], mode, 0) &&
        hides(modes[j], mode, until_s)) {
      return false;
    }
  }
  return true;
}

// Integral over a minute of exp(-d_i t) sin(w_i t) exp(-d_j t) sin(w_j t): half the difference of the real parts of
// (1 - exp(-z T)) / z at z = d_i + d_j + i (w_i -+ w_j).
double product_integral(modal::DampedMode a, modal::DampedMode b) {
  const auto integral = [](std::complex<double> z) {
    const double x = std::abs(z) * kMinute_s;
    if (x < 1e-8) return kMinute_s;
    const std::complex<double> rest = z.real() * kMinute_s > 40 ? 0.0 : std::exp(-kMinute_s * z);
    return ((1.0 - rest) / z).real();
  };
  const double decay = a.decay_per_s + b.decay_per_s;
  const double w = modal::hz_to_rad_per_s(a.frequency_hz), v = modal::hz_to_rad_per_s(b.frequency_hz);
  return 0.5 * (integral({decay, w - v}) - integral({decay, w + v}));
}

// One number for each point: the energy of the sound of the modes from `first` on.
Eigen::VectorXd energies(const modal::Bank& bank, const Eigen::MatrixXd& amplitudes, Eigen::Index first) {
  const Eigen::Index count = amplitudes.rows() - first;
  const auto part = amplitudes.bottomRows(count);
  const auto mode = [&](Eigen::Index m) {
    const auto number = static_cast<std::size_t>(first + m);
    return modal::DampedMode{bank.frequency_hz[number], bank.decay_per_s[number]};
  };
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(amplitudes.cols());
  for (Eigen::Index row = 0; row < count; row += kRowsAtOnce) {
    const Eigen::Index rows = std::min(kRowsAtOnce, count - row);
    const Eigen::MatrixXd products = Eigen::MatrixXd::NullaryExpr(
        rows, count, [&](Eigen::Index i, Eigen::Index j) { return product_integral(mode(row + i), mode(j)); });
    sum += (part.middleRows(row, rows).array() * (products * part).array()).colwise().sum().matrix().transpose();
  }
  return sum;
}

}  // namespace

std::vector<bool> audible_modes(const modal::Bank& bank, double floor_db) {
  const Eigen::MatrixXd amplitudes = strike_amplitudes(bank);
  std::vector<bool> audible(bank.mode_count(), false);
  // First any mode may mask; then only those that are heard, which brings back what only a dropped one hid.
  for (const bool first : {true, false}) {
    const std::vector<bool> may_mask = first ? std::vector<bool>(bank.mode_count(), true) : audible;
    for (Eigen::Index p = 0; p < amplitudes.cols(); ++p) {
      const std::vector<Heard> modes = heard_at(bank, amplitudes.col(p));
      for (std::size_t m = 0; m < modes.size(); ++m) {
        audible[m] = audible[m] || is_heard(modes, m, may_mask, floor_db);
      }
    }
  }
  return audible;
}

double loss_db(const modal::Bank& bank, std::size_t kept) {
  const Eigen::MatrixXd amplitudes = strike_amplitudes(bank);
  const Eigen::VectorXd lost = energies(bank, amplitudes, static_cast<Eigen::Index>(kept));
  const Eigen::VectorXd whole = energies(bank, amplitudes, 0);
  double worst = 1e-30;
  for (Eigen::Index p = 0; p < whole.size(); ++p) {
    if (whole[p] > 0) worst = std::max(worst, lost[p] / whole[p]);
  }
  return db(worst);
}

Reduced reduce(modal::Bank& bank, const Reduction& reduction) {
  const bool drop = reduction.floor_db > 0;
  std::vector<bool> audible = audible_modes(bank, drop ? reduction.floor_db : kOrderingFloor_db);
  const std::size_t always = std::min(audible.size(), static_cast<std::size_t>(reduction.always));
  std::fill_n(audible.begin(), always, true);
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto silent = std::stable_partition(order.begin(), order.end(), [&](std::size_t m) { return audible[m]; });
  const auto heard = std::max<std::size_t>(1, static_cast<std::size_t>(silent - order.begin()));
  const std::size_t wanted = drop ? heard : order.size();
  const std::size_t max = std::max(always, static_cast<std::size_t>(reduction.keep));
  const std::size_t kept = reduction.keep > 0 ? std::min(wanted, max) : wanted;

  modal::take_modes(bank, order);
  order.resize(kept);
  if (kept < audible.size()) {
    bank.provenance.dropped_modes = static_cast<std::int64_t>(audible.size() - kept);
    bank.provenance.floor_db = reduction.floor_db;
    bank.provenance.loss_db = loss_db(bank, kept);
    std::vector<std::size_t> first(kept);
    std::iota(first.begin(), first.end(), std::size_t{0});
    modal::take_modes(bank, first);
  }
  return {.inaudible = static_cast<int>(audible.size() - wanted),
          .unimportant = static_cast<int>(wanted - kept),
          .kept = std::move(order)};
}

}  // namespace ringdown::bake
