#include "engine/synth/voice.h"

#include "engine/modal/contact_pulse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <tuple>

namespace ringdown::synth {
namespace {

// The sum of |z|^2 above which something is wrong: 240 dB over full scale. Also catches what is not a number.
constexpr double kAbsurdEnergy = 1e24;
constexpr EnergyLimits kKeepAll{-1, kAbsurdEnergy};

std::size_t groups_for(std::size_t modes) { return (modes + kModePadding - 1) / kModePadding; }

struct PlayableMode {
  std::uint32_t mode;  // of the bank
  modal::DampedMode damped;
  std::complex<double> s;  // exponent per frame
};

// Those that take moments first, each kind by frequency.
std::vector<PlayableMode> playable_modes_of(const modal::Bank& bank, const modal::MaterialScale& material,
                                            double sample_rate_hz) {
  std::vector<PlayableMode> playable;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const modal::DampedMode mode = modal::rescale(bank, m, material);
    if (mode.frequency_hz <= 0 || mode.frequency_hz >= 0.5 * sample_rate_hz) continue;
    const double omega = modal::hz_to_rad_per_s(mode.frequency_hz);
    playable.push_back(
        {static_cast<std::uint32_t>(m), mode, std::complex<double>(-mode.decay_per_s, omega) / sample_rate_hz});
  }
  const auto order = [](const PlayableMode& m) {
    return std::tuple(!takes_moments(m.s), m.damped.frequency_hz, m.mode);
  };
  std::sort(playable.begin(), playable.end(),
            [&](const PlayableMode& a, const PlayableMode& b) { return order(a) < order(b); });
  return playable;
}

}  // namespace

template <class T>
Voice::Aligned<T> Voice::zeros(std::size_t count) {
  Aligned<T> block(new (kAlignment) T[count]);
  std::fill_n(block.get(), count, T{0});
  return block;
}

Voice::Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz)
    : map_(std::move(map)), place_of_(bank().mode_count(), -1), excitation_(bank().mode_count()) {
  const std::vector<PlayableMode> playable = playable_modes_of(bank(), material, sample_rate_hz);
  slow_modes_ = static_cast<std::size_t>(
      std::count_if(playable.begin(), playable.end(), [](const PlayableMode& m) { return takes_moments(m.s); }));
  const std::size_t slow_groups = groups_for(slow_modes_), fast_groups = groups_for(playable.size() - slow_modes_);
  const std::size_t groups = slow_groups + fast_groups;
  padded_ = kModePadding * groups;
  states_ = zeros<double>(kRows * padded_);
  strides_ = zeros<float>(2 * padded_);
  runs_ = zeros<float>(padded_ * 2 * kRun);
  moment_weights_ = zeros<float>(padded_ * 2 * kMoments);
  band_.assign(padded_, 0);
  for (std::vector<std::uint32_t>* list : {&groups_, &aside_groups_, &fade_groups_}) {
    list->resize(groups);
    std::iota(list->begin(), list->end(), 0);
  }
  slow_.list = groups_.data();
  fast_.list = groups_.data() + slow_groups;
  for (const PlayableMode& mode : playable) {
    const std::size_t skipped = mode_of_.size() < slow_modes_ ? 0 : kModePadding * slow_groups - slow_modes_;
    column_of_.push_back(static_cast<std::uint32_t>(mode_of_.size() + skipped));
    const double shape = modal::shape_factor(material), omega = modal::hz_to_rad_per_s(mode.damped.frequency_hz);
    weight_.push_back(kOutputScale * bank().gain * omega * shape);
    add_mode(mode.mode, mode.damped, mode.s);
  }
  if (slow_modes_ > 0)
    std::fill(band_.begin() + static_cast<std::ptrdiff_t>(slow_modes_), band_.end(), band_[slow_modes_ - 1]);
}

// Of the last column.
void Voice::add_mode(std::uint32_t mode, const modal::DampedMode& damped, std::complex<double> s) {
  const std::uint32_t at = column_of_.back();
  const auto put = [at](std::complex<double> value, auto* re, auto* im) {
    re[at] = static_cast<std::remove_reference_t<decltype(*re)>>(value.real());
    im[at] = static_cast<std::remove_reference_t<decltype(*im)>>(value.imag());
  };
  mode_of_.push_back(mode);
  place_of_[mode] = static_cast<std::int32_t>(at);
  frequency_hz_.push_back(damped.frequency_hz);
  put(std::exp(s), row(pole_re), row(pole_im));
  put(std::exp(s * static_cast<double>(kChunkFrames)), row(full_re), row(full_im));
  put(std::exp(s * static_cast<double>(kRun)), strides_.get(), strides_.get() + padded_);
  std::ranges::copy(run_of(s), runs_.get() + std::size_t{at} * 2 * kRun);
  if (mode_of_.size() > slow_modes_) return;
  band_[at] = band_of(s);
  std::ranges::copy(moment_weights(s), moment_weights_.get() + std::size_t{at} * 2 * kMoments);
}

ModeArrays Voice::modes(Row re, Row im, std::size_t frames) const RINGDOWN_REALTIME {
  ModeArrays modes{.z_re = row(re),
                   .z_im = row(im),
                   .pole_re = row(pole_re),
                   .pole_im = row(pole_im),
                   .stride_re = strides_.get(),
                   .stride_im = strides_.get() + padded_,
                   .runs = runs_.get()};
  if (frames == kChunkFrames) modes.advance_re = row(full_re), modes.advance_im = row(full_im);
  if (frames == rest_frames_) modes.advance_re = row(rest_re), modes.advance_im = row(rest_im);
  return modes;
}

void Voice::prepare(std::size_t frames) RINGDOWN_REALTIME {
  if (frames == kChunkFrames || frames == rest_frames_ || !ringing()) return;
  rest_frames_ = frames;
  fill_advances(modes(z_re, z_im, 0), padded_, frames, row(rest_re), row(rest_im));
}

bool Voice::excite(const protocol::Event& event, double* im, bool wake) RINGDOWN_REALTIME {
  const std::span<double> excitation(excitation_.data(), excitation_.size());
  if (event.type == protocol::EventType::strike_vertex) {
    if (event.vertex >= bank().point_count()) return false;
    map_->excite_vertex(event.vertex, event.impulse_ns, excitation);
  } else {
    map_->excite(event.point_m, event.impulse_ns, excitation);
  }
  // a sin(omega t) = Re(-i a exp(i omega t)): a strike lowers the imaginary part of z.
  const std::uint32_t *mode_of = mode_of_.data(), *column_of = column_of_.data();
  const double* weight = weight_.data();
  const double* frequency = frequency_hz_.data();
  double energy = 0;
  for (std::size_t i = 0; i < playable_modes(); ++i) {
    const double a = weight[i] * excitation[mode_of[i]] * modal::pulse_spectrum(frequency[i], event.contact_time_s);
    im[column_of[i]] -= a;
    energy += a * a;
  }
  // Modes that die within the chunk would take the trace of an absurd strike with them: this one stays.
  if (!(energy <= kAbsurdEnergy)) std::fill_n(im, padded_, std::numeric_limits<double>::quiet_NaN());
  if (wake) wake_all();
  return true;
}

void Voice::wake_all() RINGDOWN_REALTIME {
  slow_.count = static_cast<std::size_t>(fast_.list - slow_.list);
  fast_.count = groups_.size() - slow_.count;
  std::iota(slow_.list, slow_.list + groups_.size(), 0);
}

void Voice::take_over(const Voice& other) RINGDOWN_REALTIME {
  const std::uint32_t *mode_of = mode_of_.data(), *column_of = column_of_.data();
  const std::int32_t* place_of = other.place_of_.data();
  assert(place_of_.size() == other.place_of_.size());
  for (const Row which : {z_re, z_im, fade_re, fade_im}) {
    double* mine = row(which);
    const double* theirs = other.row(which);
    for (std::size_t i = 0; i < playable_modes(); ++i) {
      const std::int32_t place = place_of[mode_of[i]];
      mine[column_of[i]] = place < 0 ? 0.0 : theirs[place];
    }
  }
  fade_left_ = other.fade_left_;
  if (other.slow_.count + other.fast_.count > 0) wake_all();
}

void Voice::fade_out() RINGDOWN_REALTIME {
  // A fade may still be running: what is left of it joins the new one at its present level.
  const double level = static_cast<double>(fade_left_) / kFadeFrames;
  for (const auto& [from, to] : {std::pair{z_re, fade_re}, std::pair{z_im, fade_im}}) {
    for (std::size_t i = 0; i < padded_; ++i) {
      row(to)[i] = level * row(to)[i] + row(from)[i];
      row(from)[i] = 0;
    }
  }
  fade_left_ = kFadeFrames;
  slow_.count = fast_.count = 0;
}

bool Voice::render(double* out, std::size_t frames, double floor) RINGDOWN_REALTIME {
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  double energy = fade_left_ > 0 ? render_fade(out, frames) : 0.0;
  for (ActiveGroups* groups : {&slow_, &fast_}) {
    if (groups->count > 0) energy += render_modes(modes(z_re, z_im, frames), *groups, limits, out, frames);
  }
  return keep_if_sane(energy);
}

bool Voice::render_together(std::span<const MomentTarget> targets, double* out, std::size_t frames,
                            double floor) RINGDOWN_REALTIME {
  const EnergyLimits limits{floor * floor, kAbsurdEnergy};
  const ModeArrays all = modes(z_re, z_im, frames);
  double energy = fade_left_ > 0 ? render_fade(out, frames) : 0.0;
  if (fast_.count > 0) energy += render_modes(all, fast_, limits, out, frames);
  if (slow_.count > 0) {
    energy += add_moments(all, {band_.data(), moment_weights_.get()}, slow_, frames, limits, targets);
  }
  return keep_if_sane(energy);
}

bool Voice::render_aside(double* out, std::size_t frames) RINGDOWN_REALTIME {
  ActiveGroups all{aside_groups_.data(), aside_groups_.size()};
  return keep_if_sane(render_modes(modes(aside_re, aside_im, frames), all, kKeepAll, out, frames));
}

bool Voice::keep_if_sane(double energy) RINGDOWN_REALTIME {
  if (energy <= kAbsurdEnergy) return true;
  silence();
  return false;
}

void Voice::join() RINGDOWN_REALTIME {
  for (const auto& [from, to] : {std::pair{aside_re, z_re}, std::pair{aside_im, z_im}}) {
    for (std::size_t i = 0; i < padded_; ++i) {
      row(to)[i] += row(from)[i];
      row(from)[i] = 0;
    }
  }
  wake_all();
}

// Returns the energy of what fades, as render_modes() does.
double Voice::render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME {
  double sum[kChunkFrames] = {};
  ActiveGroups all{fade_groups_.data(), fade_groups_.size()};
  const double energy = render_modes(modes(fade_re, fade_im, frames), all, kKeepAll, sum, frames);
  for (std::size_t n = 0; n < frames && fade_left_ > 0; ++n, --fade_left_) {
    out[n] += sum[n] * static_cast<double>(fade_left_) / kFadeFrames;
  }
  if (fade_left_ == 0) clear_row(fade_re), clear_row(fade_im);
  return energy;
}

std::size_t Voice::sounding_modes() const RINGDOWN_REALTIME {
  return std::min(kModePadding * slow_.count, slow_modes_) +
         std::min(kModePadding * fast_.count, playable_modes() - slow_modes_);
}

void Voice::silence() RINGDOWN_REALTIME {
  for (const Row which : {z_re, z_im, aside_re, aside_im, fade_re, fade_im}) clear_row(which);
  slow_.count = fast_.count = 0;
  fade_left_ = 0;
}

void Voice::clear_row(Row which) RINGDOWN_REALTIME { std::fill_n(row(which), padded_, 0.0); }

}  // namespace ringdown::synth
