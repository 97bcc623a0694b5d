#include "engine/synth/modes/mode_table.h"

#include "engine/modal/added_decay.h"
#include "engine/modal/tubes/tube_bank.h"
#include "engine/synth/kernels/frequency_grid.h"
#include "engine/synth/kernels/pulse_kernel.h"
#include "engine/synth/modes/coupled_modes.h"
#include "engine/synth/modes/glide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace ringdown::synth {
namespace {

constexpr double kUnheard = 1e-6;  // of the loudest mode's weight: 120 dB below it

std::size_t groups_for(std::size_t modes) { return (modes + kModePadding - 1) / kModePadding; }

struct PlayableMode {
  std::uint32_t mode;  // of the bank
  modal::DampedMode damped;
  std::complex<double> s;  // exponent per frame
};

// A mode that a damper would over-damp keeps as much of its pitch as lets it die without a click, within a cycle.
modal::DampedMode damped(const modal::DampedMode& mode, double added_decay_per_s) {
  constexpr double kMaxOfOmega = 0.9;
  if (added_decay_per_s == 0 || mode.frequency_hz <= 0) return mode;
  const double lambda = modal::undamped_lambda(mode), max = kMaxOfOmega * std::sqrt(lambda);
  const double decay = std::max(mode.decay_per_s, std::min(mode.decay_per_s + added_decay_per_s, max));
  return {modal::rad_per_s_to_hz(std::sqrt(lambda - decay * decay)), decay};
}

// Far from a rigid sphere that is accelerated by a, the pressure in the direction of the motion is
// rho a R^2 / (2 r) |H|; its rms over directions is 1/sqrt(3) of that.
std::optional<ClickShape> click_of(const modal::Bank& bank, const modal::MaterialScale& material,
                                   double full_scale_pa) {
  if (!bank.mass || !(bank.mass->mass_kg > 0)) return {};
  const double radius_m = material.size * radius_of(*bank.mass);
  if (!(radius_m > 0 && radius_m <= kMaxClickRadius_m)) return {};
  const modal::Air air = modal::air_of(bank);
  const double mass_kg = modal::rescale(*bank.mass, material).mass_kg;
  const double pressure_pa = air.density_kg_m3 * radius_m * radius_m / (2 * std::numbers::sqrt3 * mass_kg);
  return ClickShape{air.sound_speed_m_s / radius_m, bank.gain * pressure_pa / full_scale_pa};
}

// Dampers of an object of another size, where they lie on its bank.
modal::Dampers as_baked(modal::Dampers dampers, double size) {
  for (auto& [number, damper] : dampers) damper.point_m = (1 / size) * damper.point_m;
  return dampers;
}

// Which modes of a bank are heard at this sample rate, in this material, under these dampers, and in which order they
// stand in the table. A mode that the material over-damps has no pitch and is left out, and so is one at or above
// the Nyquist frequency, which would alias.
//
// Modes that take moments stand first; each kind is ordered by frequency.
std::vector<PlayableMode> playable_modes_of(const modal::StrikeMap& map, const modal::MaterialScale& material,
                                            const modal::Dampers& dampers, modal::ModeRange modes,
                                            double sample_rate_hz) {
  const modal::Bank& bank = map.bank();
  const std::vector<double> added = modal::added_decay(map, as_baked(dampers, material.size));
  const double shape = modal::shape_factor(material);
  std::vector<PlayableMode> playable;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (!modes.has(map.rank(m))) continue;
    const modal::DampedMode mode = damped(modal::rescale(bank, m, material), shape * shape * added[m]);
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

// Turns what a blow gives each mode of the bank into the amplitudes of the columns; returns the sum of their squares.
double weigh(const ModeTable& table, std::span<const double> excited, double contact_time_s,
             double* amplitudes) REALTIME {
  for (std::size_t i = 0; i < table.playable_modes(); ++i) {
    amplitudes[table.column(i)] = table.output_per_velocity(i) * excited[table.mode_of(i)];
  }
  return shape_by_pulse(table.exponents().second, table.columns(), contact_time_s * table.sample_rate_hz(), amplitudes);
}

}  // namespace

ModeTable::ModeTable(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material,
                     double sample_rate_hz, modal::Dampers dampers, modal::ModeRange modes,
                     const TableSettings& settings)
    : map_(std::move(map)),
      material_(material),
      dampers_(std::move(dampers)),
      modes_(modes),
      sample_rate_hz_(sample_rate_hz),
      settings_(settings),
      per_size_(1 / material.size),
      column_of_(bank().mode_count(), -1) {
  click = click_of(bank(), material, settings.full_scale_pa);
  const std::vector<PlayableMode> playable = playable_modes_of(*map_, material, dampers_, modes_, sample_rate_hz);
  slow_modes_ = static_cast<std::size_t>(
      std::count_if(playable.begin(), playable.end(), [](const PlayableMode& m) { return takes_moments(m.s); }));
  slow_groups_ = groups_for(slow_modes_);
  columns_ = kModePadding * (slow_groups_ + groups_for(playable.size() - slow_modes_));
  rows_ = aligned_zeros<double>(kRows * columns_);
  strides_ = aligned_zeros<float>(2 * columns_);
  runs_ = aligned_zeros<float>(columns_ * 2 * kRun);
  moment_weights_ = aligned_zeros<float>(columns_ * 2 * kMoments);
  if (settings.field) line_weights_ = aligned_zeros<float>(columns_ * 2 * kGridReach);
  band_.assign(columns_, 0);
  rank_.assign(columns_, 0);
  column_hz_ = aligned_zeros<float>(columns_);
  if (bank().radiation) {
    whole_.origin_m = material.size * bank().radiation->maps.origin_m;
  } else if (bank().mass) {
    whole_.origin_m = material.size * bank().mass->center_of_mass_m;
  }
  slowest_decay_.assign(groups(), std::numeric_limits<double>::max());
  mode_of_.reserve(playable.size());
  weight_.reserve(playable.size());
  for (const PlayableMode& mode : playable) {
    const double pressure_pa = map_->loudness().pressure_pa(bank(), mode.mode, material, mode.damped.frequency_hz);
    weight_.push_back(bank().gain * pressure_pa / settings.full_scale_pa * modal::shape_factor(material));
    add_mode(mode.mode, mode.damped, mode.s);
  }
  if (slow_modes_ > 0)
    std::fill(band_.begin() + static_cast<std::ptrdiff_t>(slow_modes_), band_.end(), band_[slow_modes_ - 1]);
  if (const std::vector<double> shares = modal::tube_shares(bank()); !shares.empty()) {
    tube_shares_ = aligned_zeros<float>(columns_);
    for (std::size_t i = 0; i < playable_modes(); ++i)
      tube_shares_[column(i)] = static_cast<float>(shares[mode_of_[i]]);
  }
  if (bank().cavity) whole_.mouth_area_m2 = bank().cavity->mouth_area_m2() * material.size * material.size;
  if (!bank().nonlinear || weight_.empty()) return;
  // A mode that radiates nothing still bends the others' pitch, and only its state tells its amplitude.
  const double min = kUnheard * *std::max_element(weight_.begin(), weight_.end());
  for (double& weight : weight_) weight = std::max(weight, min);
  std::vector<double> output_per_velocity = weight_;
  for (double& output : output_per_velocity) output /= modal::shape_factor(material);
  glide = GlideMatrix::of(*this, material, output_per_velocity);
  coupled = CoupledTable::of(*this, material, output_per_velocity, settings.max_coupled);
}

// Fills in the last column.
void ModeTable::add_mode(std::uint32_t mode, const modal::DampedMode& damped, std::complex<double> s) {
  const std::size_t at = column(mode_of_.size());
  const auto put = [at](std::complex<double> value, auto* re, auto* im) {
    re[at] = static_cast<std::remove_reference_t<decltype(*re)>>(value.real());
    im[at] = static_cast<std::remove_reference_t<decltype(*im)>>(value.imag());
  };
  mode_of_.push_back(mode);
  column_of_[mode] = static_cast<std::int32_t>(at);
  rank_[at] = map_->rank(mode);
  whole_.ring_s = std::max(whole_.ring_s, std::numbers::ln10 / std::max(damped.decay_per_s, 1e-3));
  column_hz_[at] = static_cast<float>(damped.frequency_hz);
  put(s, row(exponent_re), row(exponent_im));
  put(std::exp(s), row(pole_re), row(pole_im));
  put(std::exp(s * static_cast<double>(kChunkFrames)), row(full_re), row(full_im));
  put(std::exp(s * static_cast<double>(kRun)), strides_.get(), strides_.get() + columns_);
  double& slowest = slowest_decay_[at / kModePadding];
  slowest = std::min(slowest, -s.real());
  std::ranges::copy(run_of(s), runs_.get() + std::size_t{at} * 2 * kRun);
  if (mode_of_.size() > slow_modes_) return;
  band_[at] = band_of(s);
  std::ranges::copy(moment_weights(s), moment_weights_.get() + std::size_t{at} * 2 * kMoments);
  if (line_weights_) std::ranges::copy(grid_weights(s), line_weights_.get() + std::size_t{at} * 2 * kGridReach);
}

std::optional<std::size_t> ModeTable::column_of(std::size_t mode) const REALTIME {
  const std::int32_t column = column_of_[mode];
  if (column < 0) return std::nullopt;
  return static_cast<std::size_t>(column);
}

std::optional<double> ModeTable::strike(const verb::Ring& ring, std::span<double> /*scratch*/,
                                        double* amplitudes) const REALTIME {
  const modal::ModeRange range{ring.first, ring.count};
  double energy = 0;
  for (std::size_t i = 0; i < playable_modes(); ++i) {
    const double a = range.has(map_->rank(mode_of(i))) ? ring.amplitude : 0;
    amplitudes[column(i)] = a;
    energy += a * a;
  }
  return energy;
}

std::optional<double> ModeTable::strike(const verb::Impart& impart, std::span<double> /*scratch*/,
                                        double* amplitudes) const REALTIME {
  std::fill_n(amplitudes, 2 * columns_, 0.0);
  if (impart.mode >= bank().mode_count()) return std::nullopt;
  // A mode that is not playable at this rate or in this material takes the motion and is not heard.
  const auto at = std::find(mode_of_.begin(), mode_of_.end(), map_->by_frequency()[impart.mode]);
  if (at == mode_of_.end()) return 0;
  const auto i = static_cast<std::size_t>(at - mode_of_.begin());
  const double amplitude = weight_[i] / modal::shape_factor(material_) * impart.velocity;
  amplitudes[column(i)] = amplitude * std::cos(impart.phase_rad);
  amplitudes[columns_ + column(i)] = amplitude * std::sin(impart.phase_rad);
  return amplitude * amplitude;
}

std::optional<double> ModeTable::strike(const verb::StrikeVertex& strike, std::span<double> scratch,
                                        double* amplitudes) const REALTIME {
  if (strike.vertex >= bank().point_count()) return std::nullopt;
  map_->excite_vertex(strike.vertex, strike.impulse_ns, scratch);
  return weigh(*this, scratch, strike.contact_time_s, amplitudes);
}

std::optional<double> ModeTable::strike(const verb::Strike& strike, std::span<double> scratch,
                                        double* amplitudes) const REALTIME {
  map_->excite(per_size_ * strike.point_m, strike.impulse_ns, scratch);
  return weigh(*this, scratch, strike.contact_time_s, amplitudes);
}

// A pressure in the mouth does work on the volume that comes out of it.
std::optional<double> ModeTable::strike(const verb::Slap& slap, std::span<double> scratch,
                                        double* amplitudes) const REALTIME {
  const std::optional<modal::Cavity>& cavity = bank().cavity;
  if (!cavity) return std::nullopt;
  std::ranges::fill(scratch, 0.0);
  const double pressure_pa_s = slap.impulse_ns / cavity->mouth_area_m2();
  for (const modal::Cavity::Mode& one : cavity->modes) scratch[one.mode] = one.flux * pressure_pa_s;
  return weigh(*this, scratch, slap.contact_time_s, amplitudes);
}

// A state is z = W (w q - i (v + s q)), with w the damped frequency, s the decay and W the output per modal velocity v,
// so that q = Re z / (W w); each derivative multiplies z by i w - s. weight_ has W times the scale of shapes, and so
// has the place's shape, one scale for each.
double ModeTable::find_motion(const verb::Pickup& pickup, std::span<double> scratch, float* re,
                              float* im) const REALTIME {
  map_->excite(per_size_ * pickup.point_m, pickup.direction, scratch);
  std::fill_n(re, columns_, 0.0f);
  std::fill_n(im, columns_, 0.0f);
  const double shape = modal::shape_factor(material_);
  double largest = 0;
  for (std::size_t i = 0; i < playable_modes(); ++i) {
    if (weight_[i] == 0) continue;
    const std::size_t c = column(i);
    const auto s = sample_rate_hz_ * std::complex<double>(row(exponent_re)[c], row(exponent_im)[c]);
    std::complex<double> gain = pickup.gain * shape * shape * scratch[mode_of(i)] / (weight_[i] * s.imag());
    for (std::uint32_t k = 0; k < pickup.motion; ++k)
      gain = {gain.real() * s.real() - gain.imag() * s.imag(), gain.real() * s.imag() + gain.imag() * s.real()};
    re[c] = static_cast<float>(gain.real());
    im[c] = static_cast<float>(gain.imag());
    largest = std::max(largest, std::sqrt(std::norm(gain)));
  }
  return largest;
}

void ModeTable::prepare(std::size_t frames) REALTIME {
  if (frames == kChunkFrames || frames == rest_frames_) return;
  rest_frames_ = frames;
  fill_advances(modes(nullptr, nullptr, 0), columns_, frames, row(rest_re), row(rest_im));
}

ModeArrays ModeTable::modes(double* z_re, double* z_im, std::size_t frames) const REALTIME {
  ModeArrays modes{.z_re = z_re,
                   .z_im = z_im,
                   .pole_re = row(pole_re),
                   .pole_im = row(pole_im),
                   .stride_re = strides_.get(),
                   .stride_im = strides_.get() + columns_,
                   .runs = runs_.get()};
  if (frames == kChunkFrames) {
    modes.advance_re = row(full_re);
    modes.advance_im = row(full_im);
  }
  if (frames == rest_frames_) {
    modes.advance_re = row(rest_re);
    modes.advance_im = row(rest_im);
  }
  return modes;
}

}  // namespace ringdown::synth
