#include "engine/synth/voice.h"

#include "engine/modal/contact_pulse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>

namespace ringdown::synth {
namespace {

// A voice stops when even the sum of all its modes in phase is below this: -120 dB of full scale.
constexpr double kFloor = 1e-6;

// The sum of |z|^2 above which something is wrong: 240 dB over full scale. Also catches what is not a number.
constexpr double kAbsurdEnergy = 1e24;

bool is_sane(double energy) RINGDOWN_REALTIME { return energy < kAbsurdEnergy; }

void add_samples(const double* from, double* out, std::size_t frames) RINGDOWN_REALTIME {
  for (std::size_t n = 0; n < frames; ++n) out[n] += from[n];
}

}  // namespace

Voice::Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz)
    : map_(std::move(map)), place_of_(bank().mode_count(), -1), excitation_(bank().mode_count()) {
  std::vector<std::complex<double>> poles;
  for (std::size_t m = 0; m < bank().mode_count(); ++m) {
    const modal::DampedMode mode = modal::rescale(bank(), m, material);
    if (mode.frequency_hz <= 0 || mode.frequency_hz >= 0.5 * sample_rate_hz) continue;
    const double omega = modal::hz_to_rad_per_s(mode.frequency_hz);
    place_of_[m] = static_cast<std::int32_t>(mode_of_.size());
    mode_of_.push_back(static_cast<std::uint32_t>(m));
    frequency_hz_.push_back(mode.frequency_hz);
    weight_.push_back(kOutputScale * bank().gain * omega * modal::shape_factor(material));
    poles.push_back(std::complex<double>(-mode.decay_per_s, omega) / sample_rate_hz);  // exponents, for now
  }
  padded_ = (mode_of_.size() + kModePadding - 1) / kModePadding * kModePadding;
  states_.reset(new (kAlignment) double[kRows * padded_]);
  std::fill_n(states_.get(), kRows * padded_, 0.0);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const std::complex<double> pole = std::exp(poles[i]);
    const std::complex<double> chunk_pole = std::exp(static_cast<double>(kChunkFrames) * poles[i]);
    row(pole_re)[i] = pole.real();
    row(pole_im)[i] = pole.imag();
    row(chunk_re)[i] = chunk_pole.real();
    row(chunk_im)[i] = chunk_pole.imag();
  }
}

ModeArrays Voice::modes(Row re, Row im) const RINGDOWN_REALTIME {
  return {row(re), row(im), row(pole_re), row(pole_im), row(chunk_re), row(chunk_im), padded_};
}

bool Voice::strike(const protocol::Event& event) RINGDOWN_REALTIME {
  const std::span<double> excitation(excitation_.data(), excitation_.size());
  if (event.type == protocol::EventType::strike_vertex) {
    if (event.vertex >= bank().point_count()) return false;
    map_->excite_vertex(event.vertex, event.impulse_ns, excitation);
  } else {
    map_->excite(event.point_m, event.impulse_ns, excitation);
  }
  // a sin(omega t) = Re(-i a exp(i omega t)): a strike lowers the imaginary part of z.
  const std::uint32_t* mode_of = mode_of_.data();
  const double* weight = weight_.data();
  const double* frequency = frequency_hz_.data();
  double* im = row(z_im);
  for (std::size_t i = 0; i < playable_modes(); ++i) {
    im[i] -= weight[i] * excitation[mode_of[i]] * modal::pulse_spectrum(frequency[i], event.contact_time_s);
  }
  ringing_ = playable_modes() > 0;
  return true;
}

void Voice::take_over(const Voice& other) RINGDOWN_REALTIME {
  const std::uint32_t* mode_of = mode_of_.data();
  const std::int32_t* place_of = other.place_of_.data();
  assert(place_of_.size() == other.place_of_.size());
  for (const Row which : {z_re, z_im, fade_re, fade_im}) {
    double* mine = row(which);
    const double* theirs = other.row(which);
    for (std::size_t i = 0; i < playable_modes(); ++i) {
      const std::int32_t place = place_of[mode_of[i]];
      mine[i] = place < 0 ? 0.0 : theirs[place];
    }
  }
  fade_left_ = other.fade_left_;
  ringing_ = other.ringing_;
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
  ringing_ = false;
}

bool Voice::render(double* out, std::size_t frames) RINGDOWN_REALTIME {
  // Rendered aside first: what is not a number must not reach a mix that other voices share.
  double sum[kChunkFrames] = {};
  const double fade_energy = fade_left_ > 0 ? render_fade(sum, frames) : 0.0;
  const double energy = ringing_ ? render_modes(modes(z_re, z_im), sum, frames) : 0.0;
  if (!is_sane(fade_energy) || !is_sane(energy)) {
    silence();
    return false;
  }
  add_samples(sum, out, frames);
  // |sum of z| <= sqrt(modes * sum of |z|^2), by Cauchy and Schwarz.
  ringing_ = std::sqrt(energy * static_cast<double>(playable_modes())) > kFloor;
  return true;
}

// Returns the energy of what fades, as render_modes() does.
double Voice::render_fade(double* out, std::size_t frames) RINGDOWN_REALTIME {
  double sum[kChunkFrames] = {};
  const double energy = render_modes(modes(fade_re, fade_im), sum, frames);
  for (std::size_t n = 0; n < frames && fade_left_ > 0; ++n, --fade_left_) {
    out[n] += sum[n] * static_cast<double>(fade_left_) / kFadeFrames;
  }
  if (fade_left_ == 0) std::fill_n(row(fade_re), 2 * padded_, 0.0);
  return energy;
}

void Voice::silence() RINGDOWN_REALTIME {
  std::fill_n(row(z_re), 4 * padded_, 0.0);
  ringing_ = false;
  fade_left_ = 0;
}

}  // namespace ringdown::synth
