#include "engine/synth/modes/glide.h"

#include "engine/modal/nonlinear.h"
#include "engine/synth/modes/glide_reach.h"
#include "engine/synth/modes/mode_table.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::synth {
namespace {

constexpr float kMaxShare = 127;
constexpr double kMaxReach = 1e30;  // relative, at |z| = 1: far beyond modes that are not heard at all
constexpr double kPerBand = std::numbers::pi / static_cast<double>(kChunkFrames);
constexpr double kSamePitch = 6e-5;                 // relative: 0.1 cents, below which a mode is left where it is
constexpr float kGrowth = 1.05F;                    // of the sound, from which all modes are looked at
constexpr float kFastChange = 1.2e-3F;              // relative, two cents, in which all modes are looked at once
constexpr float kSlowChange = 3e-4F;                // the same, that may pass without a look
constexpr float kMinShare = 0.1F;                   // of what pitches may move, that they are taken to move
constexpr float kMaxCalls = 8, kMaxCalmCalls = 64;  // from look to look
constexpr double kMinX = -0.5, kMaxX = 3;           // pitches from 0.7 to 2 times their own

// Returns the largest displacement of the surface for a coordinate of 1 of a mode [kg^-1/2].
double largest_shape(const modal::Bank& bank, std::size_t mode) {
  double max = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const auto [x, y, z] = bank.shape(mode, p);
    max = std::max(max, std::hypot(double{x}, double{y}, double{z}));
  }
  return max;
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
  const std::int8_t* const at = shares.data() + block * n * kModePadding;
  constexpr std::size_t kSums = 4;  // so that additions need not wait for each other
  float sums[kSums][kModePadding] = {};
  const auto add = [&](std::size_t l, std::size_t to) REALTIME {
    for (std::size_t i = 0; i < kModePadding; ++i)
      sums[to][i] += static_cast<float>(at[l * kModePadding + i]) * reached[l];
  };
  std::size_t l = 0;
  for (; l + kSums <= n; l += kSums) {
    for (std::size_t s = 0; s < kSums; ++s) add(l + s, s);
  }
  for (; l < n; ++l) add(l, 0);
  std::array<float, kModePadding> x0;
  for (std::size_t i = 0; i < kModePadding; ++i)
    x0[i] = (2 / kMaxShare) * ((sums[0][i] + sums[1][i]) + (sums[2][i] + sums[3][i]));
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
  const float next = std::clamp(until_slow_change, 1.0F, active_ ? kMaxCalls : kMaxCalmCalls);
  wait_ = waited_ = active_ && all ? 0 : static_cast<std::uint32_t>(next) - 1;
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
  const std::size_t first = block * kModePadding, end = std::min(first + kModePadding, reached_.size());
  const double* const own_im = table_.exponents().second;
  std::size_t group = columns_;  // none
  for (std::size_t m = first; m < end; ++m) {
    const std::size_t c = matrix_.columns[m];
    const double omega = own_im[c], x = std::min(stiffened(static_cast<double>(x0[m - first])), kMaxX);
    const double delta = std::min(omega * (std::sqrt(1 + x) - 1), 0.999 * std::numbers::pi - omega);
    const double moved = std::abs(delta - delta_[c]);
    moved_ = std::max(moved_, static_cast<float>(moved / omega));
    if (!anew && moved < kSamePitch * omega) continue;
    move(c, delta);
    if (c / kModePadding == group) continue;
    if (group != columns_) share_band(group);
    group = c / kModePadding;
  }
  if (group != columns_) share_band(group);
}

// The kernel takes a group to lie in one band when its first and last modes do.
void Glide::share_band(std::size_t group) REALTIME {
  if (!moments_ || group >= table_.slow_groups()) return;
  const std::size_t first = group * kModePadding;
  const std::uint16_t* const band = band_.data() + first;
  if (band[0] != band[kModePadding - 1]) return;
  if (std::all_of(band, band + kModePadding, [&](std::uint16_t b) REALTIME { return b == band[0]; })) return;
  const bool above = row(exponent_im)[first] > band[0] * kPerBand;
  const std::uint16_t other = above || band[0] == 0 ? band[0] + 1 : band[0] - 1;
  weigh(first, std::min<std::uint16_t>(other, kBands - 1));
}

// Moves a mode to `delta` above its own pitch: its pole, and what the kind of call in use reads.
void Glide::move(std::size_t c, double delta) REALTIME {
  using Phasor = std::complex<double>;
  delta_[c] = delta;
  const ModeArrays own = table_.modes(nullptr, nullptr, kChunkFrames);
  const auto [own_re, own_im] = table_.exponents();
  const auto times = [](double a_re, double a_im, double b_re, double b_im)
                         REALTIME { return Phasor(a_re * b_re - a_im * b_im, a_re * b_im + a_im * b_re); };
  const double turn_re = std::cos(delta), turn_im = std::sin(delta);
  Phasor turn(turn_re, turn_im), stride_turn, full_turn;
  for (std::size_t power = 2; power <= kChunkFrames; power *= 2) {
    turn = times(turn.real(), turn.imag(), turn.real(), turn.imag());
    if (power == kRun) stride_turn = turn;
  }
  full_turn = turn;
  row(exponent_re)[c] = own_re[c];
  row(exponent_im)[c] = own_im[c] + delta;
  const Phasor pole = times(own.pole_re[c], own.pole_im[c], turn_re, turn_im);
  const Phasor full = times(own.advance_re[c], own.advance_im[c], full_turn.real(), full_turn.imag());
  row(pole_re)[c] = pole.real();
  row(pole_im)[c] = pole.imag();
  row(full_re)[c] = full.real();
  row(full_im)[c] = full.imag();
  if (moments_ && c < table_.slow_groups() * kModePadding) {
    const long band = std::lround((own_im[c] + delta) / kPerBand);
    return weigh(c, static_cast<std::uint16_t>(std::min<long>(band, kBands - 1)));
  }
  const Phasor stride = times(static_cast<double>(own.stride_re[c]), static_cast<double>(own.stride_im[c]),
                              stride_turn.real(), stride_turn.imag());
  strides_.get()[c] = static_cast<float>(stride.real());
  strides_.get()[columns_ + c] = static_cast<float>(stride.imag());
  const float* const from = own.runs + c * 2 * kRun;
  float* const to = runs_.get() + c * 2 * kRun;
  double re = 1, im = 0;
  for (std::size_t l = 0; l < kRun; ++l) {  // a run keeps Re(p^l) and -Im(p^l)
    const Phasor power = times(static_cast<double>(from[l]), -static_cast<double>(from[kRun + l]), re, im);
    to[l] = static_cast<float>(power.real());
    to[kRun + l] = static_cast<float>(-power.imag());
    const Phasor next = times(re, im, turn_re, turn_im);
    re = next.real();
    im = next.imag();
  }
}

// The weights of moments.h for the mode's exponent, seen from the centre of `band`.
void Glide::weigh(std::size_t c, std::uint16_t band) REALTIME {
  const double delta_re = row(exponent_re)[c] * kMomentScale;
  const double delta_im = (row(exponent_im)[c] - band * kPerBand) * kMomentScale;
  const double size = std::exp(delta_re * (kMomentMiddle / kMomentScale));
  const double angle = delta_im * (kMomentMiddle / kMomentScale);
  double re = size * std::cos(angle), im = size * std::sin(angle);
  float* const weights = weights_.get() + c * 2 * kMoments;
  const double x_re = delta_re + kMomentDecay;
  for (std::size_t p = 0; p < kMoments; ++p) {
    weights[p] = static_cast<float>(re);
    weights[kMoments + p] = static_cast<float>(im);
    const double next = re * x_re - im * delta_im;
    im = re * delta_im + im * x_re;
    re = next;
  }
  band_[c] = band;
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
