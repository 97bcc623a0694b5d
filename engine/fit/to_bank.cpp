#include "engine/fit/to_bank.h"

#include "engine/modal/contact_pulse.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>

namespace ringdown::fit {

modal::Bank to_bank(std::span<const Mode> modes, const Blow& blow, double loudness, const std::string& name) {
  constexpr double kLeastOfPulse = 0.1;
  std::vector<Mode> ordered(modes.begin(), modes.end());
  std::ranges::sort(ordered, std::greater{}, [](const Mode& m) { return m.amplitude * m.amplitude / m.decay_per_s; });
  modal::Bank bank{.name = name, .positions = {{0, 0, 0}}};
  bank.provenance.generator = "ringdown " RINGDOWN_VERSION ", from a recording";
  const double per_impulse = 1 / dot(blow.impulse_ns, blow.impulse_ns);
  for (const Mode& mode : ordered) {
    bank.frequency_hz.push_back(mode.frequency_hz);
    bank.decay_per_s.push_back(mode.decay_per_s);
    bank.frequency_error.push_back(mode.frequency_error_hz / mode.frequency_hz);
    const double pulse = modal::pulse_spectrum(mode.frequency_hz, blow.contact_time_s);
    const double answer = mode.amplitude / (loudness * modal::hz_to_rad_per_s(mode.frequency_hz) *
                                            std::copysign(std::max(std::abs(pulse), kLeastOfPulse), pulse));
    const Vec3 shape =
        std::copysign(answer * per_impulse, mode.phase_rad == 0 ? 1 : std::cos(mode.phase_rad) * answer) *
        blow.impulse_ns;
    bank.shapes.push_back({static_cast<float>(shape.x), static_cast<float>(shape.y), static_cast<float>(shape.z)});
  }
  return bank;
}

}  // namespace ringdown::fit
