#include "engine/synth/modes/glide.h"

#include "engine/modal/nonlinear.h"
#include "engine/synth/kernels/glide_kernel.h"
#include "engine/synth/modes/glide_reach.h"
#include "engine/synth/modes/mode_table.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr float kMaxShare = 127;
constexpr double kMaxReach = 1e30;      // relative, at |z| = 1: far beyond modes that are not heard at all
constexpr double kSamePitch = 6e-5;     // relative: 0.1 cents, below which a mode is left where it is
constexpr float kGrowth = 1.05F;        // of the sound, from which all modes are looked at
constexpr float kFastChange = 1.2e-3F;  // relative, two cents, in which all modes are looked at once
constexpr float kSlowChange = 3e-4F;    // the same, that may pass without a look
constexpr float kMinShare = 0.1F;       // of what pitches may move, that they are taken to move
constexpr float kMaxCalls = 8;          // from look to look while pitches move
constexpr std::uint32_t kUntilExcited = std::numeric_limits<std::uint32_t>::max();
constexpr double kMinX = -0.5, kMaxX = 3;  // pitches from 0.7 to 2 times their own

// Returns the largest displacement of the surface for a coordinate of 1 of a mode [kg^-1/2].
double largest_shape(const modal::Bank& bank, std::size_t mode) {
  double max = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const auto [x, y, z] = bank.shape(mode, p);
    max = std::max(max, std::hypot(double{x}, double{y}, double{z}));
  }
  return max;
}

// The run of a mode, Re(p^l) and -Im(p^l), when p is multiplied by `turn`.
void turn_run(const float* from, std::complex<double> turn, float* to) REALTIME {
  double re = 1, im = 0;
  for (std::size_t l = 0; l < kRun; ++l) {
    const auto own_re = static_cast<double>(from[l]), own_im = -static_cast<double>(from[kRun + l]);
    to[l] = static_cast<float>(own_re * re - own_im * im);
    to[kRun + l] = static_cast<float>(-(own_re * im + own_im * re));
    const double next = re * turn.real() - im * turn.imag();
    im = re * turn.imag() + im * turn.real();
    re = next;
  }
}

}  // namespace

double stiffened(double x0) REALTIME {
  if (x0 <= 0) return std::max(x0, kMinX);
  return 0.75 * (std::sqrt(1 + 8.0 / 3 * x0) - 1);
}

std::vector<GlidingMode> GlideMatrix::lowest(const ModeTable& table, const modal::MaterialScale& material,
                                             const std::vector<double>& output_per_velocity, std::size_t max) {
  const modal::Bank& bank = table.bank();
  std::vector<GlidingMode> modes;
  for (std::size_t i = 0; i < table.playable_modes(); ++i) {
    const std::size_t mode = table.mode_of(i);
    const auto& named = bank.nonlinear->modes;
    if (std::find(named.begin(), named.end(), mode) == named.end() || !(output_per_velocity[i] > 0)) continue;
    modes.push_back({std::sqrt(modal::undamped_lambda(modal::rescale(bank, mode, material))), mode, i});
  }
  std::sort(modes.begin(), modes.end(),
            [](const GlidingMode& a, const GlidingMode& b) { return a.omega_rad_s < b.omega_rad_s; });
  modes.resize(std::min(modes.size(), max));
  return modes;
}

std::shared_ptr<const GlideMatrix> GlideMatrix::of(const ModeTable& table, const modal::MaterialScale& material,
                                                   const std::vector<double>& output_per_velocity) {
  const modal::Bank& bank = table.bank();
  if (!bank.nonlinear) return nullptr;
  const std::vector<GlidingMode> gliding = lowest(table, material, output_per_velocity, kMaxGlidingModes);
  if (gliding.empty()) return nullptr;

  std::vector<std::size_t> order;
  for (const GlidingMode& mode : gliding) order.push_back(mode.mode);
  modal::NonlinearTerms terms = *bank.nonlinear;
  modal::take_modes(terms, order);
  modal::rescale(terms, material);
  const std::size_t n = gliding.size();
  std::vector<double> omega(n);
  for (std::size_t i = 0; i < n; ++i) omega[i] = gliding[terms.modes[i]].omega_rad_s;
  const std::vector<double> b = modal::detuning(terms, omega);

  auto matrix = std::make_shared<GlideMatrix>();
  matrix->shares.resize((n + kModePadding - 1) / kModePadding * kModePadding * n);
  matrix->reach.assign(n, 0);
  const double per_thickness = modal::shape_factor(material) / terms.thickness_m;
  for (std::size_t l = 0; l < n; ++l) {
    const std::size_t playable = gliding[terms.modes[l]].playable;
    matrix->columns.push_back(static_cast<std::uint32_t>(table.column(playable)));
    const double displacement = 1 / (omega[l] * output_per_velocity[playable]);
    const double bend = largest_shape(bank, gliding[terms.modes[l]].mode) * displacement * per_thickness;
    matrix->bend.push_back(terms.thickness_m > 0 ? static_cast<float>(bend * bend) : 0.0F);
    const auto relative = [&](std::size_t m) { return b[m * n + l] * displacement * displacement / omega[m]; };
    double reach = 0;
    for (std::size_t m = 0; m < n; ++m) reach = std::max(reach, std::abs(relative(m)));
    const bool reaches = reach > 0 && reach <= kMaxReach;  // beyond, the numbers of the bank are absurd
    matrix->reach[l] = reaches ? static_cast<float>(reach) : 0.0F;
    for (std::size_t m = 0; m < n && reaches; ++m) {
      const double share = relative(m) / reach;
      if (!(std::abs(share) <= 1)) continue;  // not a number
      matrix->shares[(m / kModePadding * n + l) * kModePadding + m % kModePadding] =
          static_cast<std::int8_t>(std::lround(kMaxShare * share));
    }
  }
  return matrix;
}

std::array<float, kModePadding> GlideMatrix::detuned(std::size_t block, const float* reached) const REALTIME {
  const std::size_t n = columns.size();
  std::array<float, kModePadding> x0;
  add_shares(shares.data() + block * n * kModePadding, reached, n, x0.data());
  for (float& x : x0) x *= 2 / kMaxShare;
  return x0;
}

Glide::Glide(const ModeTable& table)
    : columns_(table.columns()),
      rows_(aligned_zeros<double>(kRows * columns_)),
      strides_(aligned_zeros<float>(2 * columns_)),
      runs_(aligned_zeros<float>(columns_ * 2 * kRun)),
      weights_(aligned_zeros<float>(columns_ * 2 * kMoments)),
      band_(columns_),
      table_(table),
      matrix_(*table.glide),
      reached_(matrix_.columns.size()),
      delta_(columns_) {
  const ModeArrays modes = table.modes(nullptr, nullptr, kChunkFrames);
  const auto [log_re, log_im] = table.exponents();
  std::copy_n(modes.pole_re, columns_, row(pole_re));
  std::copy_n(modes.pole_im, columns_, row(pole_im));
  std::copy_n(modes.advance_re, columns_, row(full_re));
  std::copy_n(modes.advance_im, columns_, row(full_im));
  std::copy_n(log_re, columns_, row(exponent_re));
  std::copy_n(log_im, columns_, row(exponent_im));
  std::copy_n(modes.stride_re, columns_, strides_.get());
  std::copy_n(modes.stride_im, columns_, strides_.get() + columns_);
  std::copy_n(modes.runs, columns_ * 2 * kRun, runs_.get());
  const MomentArrays moments = table.moments();
  std::copy_n(moments.weights, columns_ * 2 * kMoments, weights_.get());
  std::copy_n(moments.band, columns_, band_.data());
}

void Glide::follow(const double* re, const double* im, bool moments) REALTIME {
  if (wait_ > 0 && (!active_ || moments == moments_)) {
    --wait_;
    return;
  }
  const std::size_t n = reached_.size();
  const std::uint32_t* const columns = matrix_.columns.data();
  float* const reached = reached_.data();
  float sums[4] = {};
  for (std::size_t l = 0; l < n; ++l) {
    const std::uint32_t c = columns[l];
    reached[l] = synth::reached(matrix_, l, static_cast<float>(re[c] * re[c] + im[c] * im[c]));
    sums[l % 4] += reached[l];
  }
  const float total = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  const bool begins = !active_;
  active_ = total > (begins ? 1.0F : 0.5F) * kMinDetuning;
  const bool anew = begins || moments != moments_, all = anew || total > kGrowth * total_;
  if (all) {
    share_ = 1;
    next_ = 0;
  }
  const float could_change = std::abs(total - total_), change = share_ * could_change;
  could_move_ += could_change;
  const float calls = 1.0F + static_cast<float>(waited_);
  const float until_slow_change = kSlowChange * calls / std::max(change, 1e-9F);
  const float next = std::clamp(until_slow_change, 1.0F, kMaxCalls);
  wait_ = waited_ = active_ && all ? 0 : static_cast<std::uint32_t>(next) - 1;
  if (!active_) wait_ = kUntilExcited;  // what is calm and rings freely only gets calmer
  total_ = total;
  if (!active_) return;
  moments_ = moments;
  const std::size_t max = (n + kModePadding - 1) / kModePadding;
  due_ = all || wait_ > 0 ? due_ : due_ + static_cast<float>(max) * std::min(change / kFastChange, 1.0F);
  const std::size_t count = all ? max : wait_ > 0 ? 1 : std::min(max, static_cast<std::size_t>(due_));
  due_ -= std::min(due_, static_cast<float>(count));
  for (std::size_t i = 0; i < count; ++i) {
    look_at_block(next_, anew);
    if (++next_ < max) continue;
    next_ = 0;
    if (!all) share_ = std::clamp(moved_ / std::max(could_move_, 1e-9F), kMinShare, 1.0F);
    moved_ = could_move_ = 0;
  }
}

void Glide::look_at_block(std::size_t block, bool anew) REALTIME {
  const std::array<float, kModePadding> x0 = matrix_.detuned(block, reached_.data());
  const std::size_t first = block * kModePadding, end = std::min(first + kModePadding, matrix_.columns.size());
  const double* const own_im = table_.exponents().second;
  Moving moving;
  for (std::size_t m = first; m < end; ++m) {
    const std::size_t c = matrix_.columns[m];
    const double omega = own_im[c], x = std::min(stiffened(static_cast<double>(x0[m - first])), kMaxX);
    const double delta = std::min(omega * (std::sqrt(1 + x) - 1), 0.999 * std::numbers::pi - omega);
    const double moved = std::abs(delta - delta_[c]);
    moved_ = std::max(moved_, static_cast<float>(moved / omega));
    if (!anew && moved < kSamePitch * omega) continue;
    delta_[c] = delta;
    moving.columns[moving.count++] = static_cast<std::uint32_t>(c);
  }
  if (moving.count > 0) move(moving);
}

// The kernel takes a group to lie in one band when its first and last modes do.
void Glide::share_band(std::size_t group) REALTIME {
  const std::size_t first = group * kModePadding;
  const std::uint16_t* const band = band_.data() + first;
  if (band[0] != band[kModePadding - 1]) return;
  if (std::all_of(band, band + kModePadding, [&](std::uint16_t b) REALTIME { return b == band[0]; })) return;
  const bool above = row(exponent_im)[first] > band[0] * kPerBand;
  const std::uint16_t other = above || band[0] == 0 ? band[0] + 1 : band[0] - 1;
  band_[first] = std::min<std::uint16_t>(other, kBands - 1);
  weigh({{static_cast<std::uint32_t>(first)}, 1});
}

// Moves modes to delta_ above their own pitch: their poles, and what the kind of call in use reads.
void Glide::move(const Moving& moving) REALTIME {
  const ModeArrays own = table_.modes(nullptr, nullptr, kChunkFrames);
  const auto [own_re, own_im] = table_.exponents();
  alignas(64) double angles[kModePadding] = {};
  for (std::size_t i = 0; i < moving.count; ++i) angles[i] = delta_[moving.columns[i]];
  Turns turns;
  find_turns(angles, turns);
  Moving weighed;
  for (std::size_t i = 0; i < moving.count; ++i) {
    const std::size_t c = moving.columns[i];
    const auto turned = [i](double re, double im, const Turns::Row& by) REALTIME {
      return std::pair(re * by.re[i] - im * by.im[i], re * by.im[i] + im * by.re[i]);
    };
    row(exponent_re)[c] = own_re[c];
    row(exponent_im)[c] = own_im[c] + delta_[c];
    std::tie(row(pole_re)[c], row(pole_im)[c]) = turned(own.pole_re[c], own.pole_im[c], turns.frame);
    std::tie(row(full_re)[c], row(full_im)[c]) = turned(own.advance_re[c], own.advance_im[c], turns.chunk);
    if (moments_ && c < table_.slow_groups() * kModePadding) {
      const double band = std::round(row(exponent_im)[c] / kPerBand);
      band_[c] = static_cast<std::uint16_t>(std::min<double>(band, kBands - 1));
      weighed.columns[weighed.count++] = static_cast<std::uint32_t>(c);
      continue;
    }
    const auto stride = turned(double{own.stride_re[c]}, double{own.stride_im[c]}, turns.run);
    strides_.get()[c] = static_cast<float>(stride.first);
    strides_.get()[columns_ + c] = static_cast<float>(stride.second);
    turn_run(own.runs + c * 2 * kRun, {turns.frame.re[i], turns.frame.im[i]}, runs_.get() + c * 2 * kRun);
  }
  if (weighed.count == 0) return;
  weigh(weighed);
  std::size_t group = columns_;  // none
  for (std::size_t i = 0; i < weighed.count; ++i) {
    const std::size_t next = weighed.columns[i] / kModePadding;
    if (next != group) share_band(next);
    group = next;
  }
}

// Finds the weights of moments of modes that moved, or whose band has changed.
void Glide::weigh(const Moving& moving) REALTIME {
  MovedWeights weights = {};
  for (std::size_t i = 0; i < moving.count; ++i) {
    const std::size_t c = moving.columns[i];
    weights.decay[i] = row(exponent_re)[c];
    weights.omega[i] = row(exponent_im)[c];
    weights.band[i] = band_[c];
  }
  find_weights(weights);
  for (std::size_t i = 0; i < moving.count; ++i) {
    float* const to = weights_.get() + moving.columns[i] * 2 * kMoments;
    for (std::size_t p = 0; p < 2 * kMoments; ++p) to[p] = weights.of[p][i];
  }
}

void Glide::apply(ModeArrays& modes, std::size_t frames) const REALTIME {
  modes.pole_re = row(pole_re);
  modes.pole_im = row(pole_im);
  const bool full = frames == kChunkFrames;
  modes.advance_re = full ? row(full_re) : nullptr;
  modes.advance_im = full ? row(full_im) : nullptr;
  modes.stride_re = strides_.get();
  modes.stride_im = strides_.get() + columns_;
  modes.runs = runs_.get();
}

}  // namespace ringdown::synth
