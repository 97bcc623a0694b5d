#include "engine/synth/modes/coupled_modes.h"

#include "engine/modal/nonlinear.h"
#include "engine/synth/modes/glide.h"
#include "engine/synth/modes/mode_table.h"
#include "engine/synth/modes/sane_samples.h"
#include "engine/synth/modes/state_array.h"
#include "engine/synth/modes/work_cost.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace ringdown::synth {
namespace {

static_assert(modal::kMaxCoupled <= kMaxCoupledStride);

constexpr double kShiftOverEnergy = 20;  // C over the energy, at least
constexpr double kPsiControl_per_s = 300;
constexpr double kFade = 0.99;  // a frame

// Copies one function's matrix into the kernel's padded form.
void pad(const modal::NonlinearTerms& terms, std::size_t k, CoupledTable& table) {
  const std::size_t stride = table.arrays.stride;
  for (std::size_t i = 0; i < terms.mode_count(); ++i) {
    table.curving.get()[k * stride + i] = terms.g(k, i);
    for (std::size_t j = 0; j < terms.mode_count(); ++j)
      table.bending.get()[(k * stride + i) * stride + j] = terms.h(k, i, j);
  }
}

}  // namespace

std::shared_ptr<const CoupledTable> CoupledTable::of(const ModeTable& table, const modal::MaterialScale& material,
                                                     const std::vector<double>& output_per_velocity, std::size_t max) {
  const modal::Bank& bank = table.bank();
  if (!bank.nonlinear || bank.nonlinear->coupled == 0) return nullptr;
  const std::vector<GlidingMode> lowest =
      GlideMatrix::lowest(table, material, output_per_velocity, std::min<std::size_t>(bank.nonlinear->coupled, max));
  if (lowest.empty()) return nullptr;
  std::vector<std::size_t> order;
  for (const GlidingMode& mode : lowest) order.push_back(mode.mode);
  modal::NonlinearTerms terms = *bank.nonlinear;
  modal::take_modes(terms, order);
  modal::rescale(terms, material);

  auto coupled = std::make_shared<CoupledTable>();
  const std::size_t n = lowest.size(), wanted = terms.function_count();
  const std::size_t functions = max > kMaxCoupledModes ? wanted : std::min(wanted, kMaxCoupledFunctions);
  const std::size_t stride = (n + kCoupledPadding - 1) / kCoupledPadding * kCoupledPadding;
  coupled->bending = aligned_zeros<float>(functions * stride * stride);
  coupled->curving = aligned_zeros<float>(functions * stride);
  coupled->arrays = {coupled->bending.get(), coupled->curving.get(), functions, stride};
  coupled->frame_s = 1 / table.sample_rate_hz();
  coupled->units_per_frame = kCoupledPerTerm * static_cast<double>(functions * stride * stride);
  for (std::size_t k = 0; k < functions; ++k) pad(terms, k, *coupled);
  const ModeArrays modes = table.modes(nullptr, nullptr, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const GlidingMode& mode = lowest[terms.modes[i]];
    const std::size_t column = table.column(mode.playable);
    coupled->columns.push_back(static_cast<std::uint32_t>(column));
    coupled->pole_re.push_back(modes.pole_re[column]);
    coupled->pole_im.push_back(modes.pole_im[column]);
    coupled->output.push_back(output_per_velocity[mode.playable] * mode.omega_rad_s);
    const auto& gliding = table.glide->columns;
    const auto place = std::find(gliding.begin(), gliding.end(), column) - gliding.begin();
    const bool glides = place < std::ssize(gliding);
    coupled->gliding.push_back(glides ? static_cast<std::int32_t>(place) : -1);
    coupled->detuning.push_back(glides ? double{table.glide->reach[static_cast<std::size_t>(place)]} : 0.0);
  }
  return coupled;
}

CoupledModes::CoupledModes(const CoupledTable& table)
    : table_(table),
      modes_(table.columns.size()),
      now_(modes_),
      before_(modes_),
      place_(aligned_zeros<float>(table.arrays.stride)),
      gradient_(aligned_zeros<float>(table.arrays.stride)) {
  const double k2 = table.frame_s * table.frame_s;
  for (std::size_t m = 0; m < modes_; ++m) {
    const double keep = table.pole_re[m] * table.pole_re[m] + table.pole_im[m] * table.pole_im[m];
    turn_.push_back(2 * table.pole_re[m]);
    keep_.push_back(keep);
    push_.push_back(2 * k2 / (1 + keep));
    stiff_.push_back((2 - 2 * turn_[m] / (1 + keep)) / k2);
    per_force_.push_back(table.output[m] / stiff_[m]);
  }
}

double CoupledModes::strength(const double* re, const double* im) const REALTIME {
  double sum = 0;
  const CoupledTable& t = table_;
  for (std::size_t m = 0; m < modes_; ++m) {
    const std::size_t c = t.columns[m];
    double z_re = re[c], z_im = im[c];
    if (running_) {
      z_re += t.output[m] * now_[m];
      z_im += state_im(m);
    }
    sum += t.detuning[m] * (z_re * z_re + z_im * z_im);
  }
  return sum;
}

double CoupledModes::state_im(std::size_t m) const REALTIME {
  const double kept = keep_[m] * before_[m] - table_.pole_re[m] * now_[m];
  return table_.output[m] * kept / table_.pole_im[m];
}

double CoupledModes::amplitude() const REALTIME {
  double sum = 0;
  for (std::size_t m = 0; m < modes_; ++m) {
    const double re = table_.output[m] * now_[m], im = state_im(m);
    sum += std::sqrt(re * re + im * im);
  }
  return sum;
}

void CoupledModes::add_squares(float* squares) const REALTIME {
  for (std::size_t m = 0; m < modes_; ++m) {
    const double re = table_.output[m] * now_[m], im = state_im(m);
    const std::int32_t place = table_.gliding[m];
    if (place >= 0) squares[place] += static_cast<float>(re * re + im * im);
  }
}

double CoupledModes::linear_energy() const REALTIME {
  double sum = 0;
  const double per_s = 1 / table_.frame_s;
  for (std::size_t m = 0; m < modes_; ++m) {
    const double q = now_[m], last = before_[m], v = (q - last) * per_s;
    sum += 0.5 * (v * v + stiff_[m] * q * last);
  }
  return sum;
}

double CoupledModes::energy_j() const REALTIME { return linear_energy() + 0.5 * (psi_ * psi_ - shift_); }

// V halfway between the last two samples, where psi stands.
double CoupledModes::potential_at_middle() REALTIME {
  for (std::size_t m = 0; m < modes_; ++m) place_.get()[m] = static_cast<float>(0.5 * (now_[m] + before_[m]));
  return coupled_forces(table_.arrays, place_.get(), gradient_.get());
}

void CoupledModes::take(double* re, double* im) REALTIME {
  const CoupledTable& t = table_;
  bool any = false;
  for (std::size_t m = 0; m < modes_; ++m) any = any || re[t.columns[m]] != 0 || im[t.columns[m]] != 0;
  if (!any) return;
  const double before_v = running_ ? potential_at_middle() : 0;
  const double off = running_ ? psi_ - std::sqrt(std::max(2 * before_v + shift_, 0.0)) : 0;
  for (std::size_t m = 0; m < modes_; ++m) {
    const std::size_t c = t.columns[m];
    const double p_re = t.pole_re[m], p_im = t.pole_im[m], output = t.output[m];
    if (!running_) now_[m] = before_[m] = 0;
    now_[m] += re[c] / output;
    before_[m] += (re[c] * p_re + im[c] * p_im) / (keep_[m] * output);
    re[c] = im[c] = 0;
  }
  const double v = potential_at_middle();
  const double old_shift = running_ ? shift_ : 0;
  shift_ = std::max(old_shift, kShiftOverEnergy * (linear_energy() + std::abs(v)));
  psi_ = std::sqrt(std::max(2 * v + shift_, 0.0)) + off * std::sqrt(old_shift / shift_);
  running_ = taken_ = true;
}

// Returns what the forces add to the sound at the sample that is left.
double CoupledModes::step() REALTIME {
  double *const now = now_.data(), *const before = before_.data();
  float *const place = place_.get(), *const gradient = gradient_.get();
  for (std::size_t m = 0; m < modes_; ++m) place[m] = static_cast<float>(now[m]);
  const double v = coupled_forces(table_.arrays, place, gradient);
  const double truth = std::sqrt(std::max(2 * v + shift_, 0.5 * shift_)), per_truth = 1 / truth;
  const double per_s = 1 / table_.frame_s;
  double speed = 0;
  for (std::size_t m = 0; m < modes_; ++m) {
    const double velocity = (now[m] - before[m]) * per_s;
    speed += velocity * velocity;
  }
  const double control = kPsiControl_per_s * (psi_ - truth) / (speed + 1e-9 * shift_);
  const double *turn = turn_.data(), *keep = keep_.data(), *push = push_.data();
  double along = 0, size = 0;
  for (std::size_t m = 0; m < modes_; ++m) {
    gradient[m] =
        static_cast<float>(static_cast<double>(gradient[m]) * per_truth - control * (now[m] - before[m]) * per_s);
    const auto g = static_cast<double>(gradient[m]);
    const double free = turn[m] * now[m] - keep[m] * before[m];
    along += g * (free - before[m]);
    size += g * g * push[m];
    const double last = now[m];
    now[m] = free;
    before[m] = last;
  }
  // q+ = free - push g (psi + change / 2) with change = g . (q+ - q-) / 2, solved for the change. g may be any
  // vector, floats too: the balance is exact.
  const double change = (0.5 * along - 0.5 * size * psi_) / (1 + 0.25 * size);
  const double middle = psi_ + 0.5 * change;
  const double* const per_force = per_force_.data();
  double forced = 0;
  for (std::size_t m = 0; m < modes_; ++m) {
    const double force = static_cast<double>(gradient[m]) * middle;
    now[m] -= push[m] * force;
    forced += per_force[m] * force;
  }
  psi_ += change;
  psi_over_truth_ = middle * per_truth;
  return forced;
}

bool CoupledModes::render(double* out, std::size_t frames, std::span<const Probes::One> probes) REALTIME {
  const double* const output = table_.output.data();
  std::array<double, kChunkFrames> samples;
  assert(frames <= samples.size());
  for (std::size_t n = 0; n < frames; ++n) {
    double sum = 0;
    for (std::size_t m = 0; m < modes_; ++m) sum += output[m] * now_[m];
    for (const Probes::One& probe : probes) {
      double motion = 0;
      for (std::size_t m = 0; m < modes_; ++m) {
        const std::size_t c = table_.columns[m];
        motion += static_cast<double>(probe.gain_re[c]) * output[m] * now_[m] -
                  static_cast<double>(probe.gain_im[c]) * state_im(m);
      }
      probe.to[n] += motion;
    }
    const double forced = step();
    if (taken_) fading_ += forced_ - forced;
    taken_ = false;
    samples[n] = sum + forced + fading_;
    forced_ = forced;
    fading_ *= kFade;
  }
  // Written so that what is not a number lies below no limit.
  const double max = std::sqrt(kAbsurdEnergy);
  running_ = std::isfinite(psi_) && std::isfinite(linear_energy()) && amplitude() <= max && std::abs(forced_) <= max &&
             std::abs(fading_) <= max && are_sane({samples.data(), frames});
  if (running_) {
    for (std::size_t n = 0; n < frames; ++n) out[n] += samples[n];
  } else {
    cut_off();
  }
  return running_;
}

void CoupledModes::fade(double* out, std::size_t frames) REALTIME {
  constexpr double kSilent = 1e-9;
  fading_ += std::exchange(forced_, 0.0);
  if (std::abs(fading_) < kSilent) fading_ = 0;
  for (std::size_t n = 0; n < frames && fading_ != 0; ++n) {
    out[n] += fading_;
    fading_ *= kFade;
  }
}

void CoupledModes::give_back(double* re, double* im) REALTIME {
  const CoupledTable& t = table_;
  for (std::size_t m = 0; m < modes_; ++m) {
    const std::size_t c = t.columns[m];
    re[c] += t.output[m] * now_[m];
    im[c] += state_im(m);
  }
  running_ = false;
}

Coupling::Coupling(const ModeTable& table) {
  if (table.coupled) modes_ = std::make_unique<CoupledModes>(*table.coupled);
}

Coupling::Outcome Coupling::render(double* re, double* im, bool allowed, double* out, std::size_t frames,
                                   std::span<const Probes::One> probes) REALTIME {
  constexpr double kBegin = 0.004, kEnd = 0.001;  // relative detuning: 7 and 1.7 cents
  if (!modes_) return Outcome::nothing;
  if (!allowed || !affordable || !(modes_->strength(re, im) > (modes_->running() ? kEnd : kBegin))) {
    const bool ended = give_back(re, im);
    modes_->fade(out, frames);
    return ended ? Outcome::ended : Outcome::nothing;
  }
  modes_->take(re, im);
  return modes_->render(out, frames, probes) ? Outcome::rendered : Outcome::absurd;
}

bool Coupling::give_back(double* re, double* im) REALTIME {
  if (!running()) return false;
  modes_->give_back(re, im);
  return true;
}

}  // namespace ringdown::synth
