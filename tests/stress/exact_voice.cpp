#include "tests/stress/exact_voice.h"
#include "tests/support/synthetic_bank.h"

#include <utility>

namespace ringdown::synth::test {

ExactVoice::ExactVoice(Map map, double rate_hz, const modal::MaterialScale& material)
    : map_(std::move(map)), modes_(map_->bank().mode_count()) {
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const modal::DampedMode damped = modal::rescale(map_->bank(), m, material);
    if (damped.frequency_hz <= 0 || damped.frequency_hz >= rate_hz / 2) continue;
    const long double omega = 2 * std::numbers::pi_v<long double> * static_cast<long double>(damped.frequency_hz);
    modes_[m] = {.plays = true,
                 .frequency_hz = damped.frequency_hz,
                 .s = Exact(-static_cast<long double>(damped.decay_per_s), omega) / static_cast<long double>(rate_hz),
                 .weight = ringdown::test::kLoudness * omega * map_->bank().gain / material.density};
  }
}

void ExactVoice::advance(Frame to) {
  const auto frames = static_cast<long double>(to - at_);
  at_ = to;
  if (frames == 0) return;
  for (ExactMode& mode : modes_) {
    if (mode.size + mode.lost == 0) continue;
    mode.z *= std::polar(std::exp(mode.s.real() * frames), mode.s.imag() * frames);
    mode.lost *= static_cast<double>(std::exp(mode.s.real() * frames));
    mode.size = static_cast<double>(std::abs(mode.z));
  }
}

double ExactVoice::strike(const Event& event, double floor) {
  const modal::Bank& bank = map_->bank();
  std::vector<double> at_point(modes_.size());
  const auto* strike = event.verb.get_if<verb::Strike>();
  const auto* vertex = event.verb.get_if<verb::StrikeVertex>();
  if (strike) map_->excite(strike->point_m, strike->impulse_ns, at_point);
  const double contact_time_s = strike ? strike->contact_time_s : vertex->contact_time_s;
  advance(event.frame);
  double added = 0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    ExactMode& mode = modes_[m];
    if (!mode.plays) continue;
    long double along = at_point[m];
    if (vertex) {
      const modal::Vec3f& shape = bank.shape(m, vertex->vertex);
      const Vec3& impulse_ns = vertex->impulse_ns;
      along = shape[0] * impulse_ns.x + shape[1] * impulse_ns.y + shape[2] * impulse_ns.z;
    }
    const long double a = mode.weight * along * pulse_factor(mode.frequency_hz, contact_time_s);
    if (mode.size - mode.lost <= floor) mode.lost = std::max(mode.lost, mode.size);
    mode.z -= Exact(0, a);
    mode.size = static_cast<double>(std::abs(mode.z));
    added += static_cast<double>(std::abs(a));
  }
  return added;
}

void ExactVoice::take_over(const ExactVoice& other, Frame now) {
  ExactVoice old = other;
  old.advance(now);
  at_ = now;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    ExactMode& mode = modes_[m];
    if (mode.plays) mode.z = old.modes_[m].z, mode.size = old.modes_[m].size, mode.lost = old.modes_[m].lost;
  }
}

bool ExactVoice::has_more_than(const ExactVoice& other) const {
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    if (modes_[m].plays && !other.modes_[m].plays) return true;
  }
  return false;
}

void ExactVoice::silence() {
  for (ExactMode& mode : modes_) mode.z = 0, mode.size = mode.lost = 0;
}

double ExactVoice::loudness(Frame when) const {
  const auto frames = static_cast<double>(when - at_);
  double sum = 0;
  for (const ExactMode& mode : modes_) {
    const double max = mode.size + mode.lost;
    if (max > 0) sum += max * std::exp(static_cast<double>(mode.s.real()) * frames);
  }
  return sum;
}

Samples ExactVoice::samples(Frame first, std::size_t count) const {
  Samples sum(count, 0.0);
  const auto frames = static_cast<long double>(first - at_);
  for (const ExactMode& mode : modes_) {
    if (mode.size == 0) continue;
    Exact z = mode.z * std::polar(std::exp(mode.s.real() * frames), mode.s.imag() * frames);
    const Exact pole = std::polar(std::exp(mode.s.real()), mode.s.imag());
    for (double& sample : sum) {
      sample += static_cast<double>(z.real());
      z *= pole;
    }
  }
  return sum;
}

}  // namespace ringdown::synth::test
