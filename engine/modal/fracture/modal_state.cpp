#include "engine/modal/fracture/modal_state.h"

#include "engine/base/rotation.h"
#include "engine/modal/hearing/contact_pulse.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

// The response of a mode to a half sine
//
// An impulse at time u leaves the amplitude -i b / omega, which then moves by p = -d + i omega. A force of the shape
// s(u) = (W/2) sin(W u), W = pi / tau, of integral 1 over its duration tau, has therefore at time t made the amplitude
// -i (b / omega) H with
//
//   H(p, t) = integral from 0 to t of s(u) exp(p (t - u)) du
//           = (W t / 4i) exp(p t) (E((iW - p) t) - E((-iW - p) t)),        E(y) = (exp(y) - 1) / y
//
// E has no pole, so that omega = W needs no special case. Without damping, -i H / omega has the real part and the
// derivative of
//   q = (W/2) / (omega^2 - W^2) (sin W t - W/omega sin omega t).
// The shape is symmetric, so what comes after t, seen from t, is H(-p, tau - t).
namespace ringdown::modal {
namespace {

using Complex = std::complex<double>;

Complex exponent_of(const DampedMode& mode) { return {-mode.decay_per_s, hz_to_rad_per_s(mode.frequency_hz)}; }

// (exp(y) - 1) / y without cancellation.
Complex mean_exponential(Complex y) {
  if (std::abs(y) < 1e-8) return 1.0 + y / 2.0;
  const double half = std::sin(y.imag() / 2);
  const Complex minus_one{std::expm1(y.real()) * std::cos(y.imag()) - 2 * half * half,
                          std::exp(y.real()) * std::sin(y.imag())};
  return minus_one / y;
}

// H(p, elapsed_s) for a half sine of `duration_s` > 0. The factor exp(p t) is drawn into both terms, so that strong
// damping underflows instead of making infinity times zero.
Complex pulse_response(Complex p, double duration_s, double elapsed_s) {
  const double w = std::numbers::pi / duration_s;
  const auto term = [&](double sign) {  // exp(p t) E(y) = exp(iWt) E(-y)
    const Complex y = (Complex(0, sign * w) - p) * elapsed_s;
    return y.real() > 0 ? std::polar(1.0, sign * w * elapsed_s) * mean_exponential(-y)
                        : std::exp(p * elapsed_s) * mean_exponential(y);
  };
  return Complex(0, -w * elapsed_s / 4) * (term(1) - term(-1));
}

// Adds -i b_j / omega_j times response(j) to each mode, and a share of the impulse to the rigid motion.
template <class Response>
void add_to(ModalState& state, const Blow& blow, double share, const Response& response) {
  assert(blow.modal_impulse.size() == state.modes.size() && state.amplitudes.size() == state.modes.size());
  for (std::size_t j = 0; j < state.modes.size(); ++j) {
    if (state.modes[j].frequency_hz <= 0) continue;
    const double displaced = blow.modal_impulse[j] / hz_to_rad_per_s(state.modes[j].frequency_hz);
    state.amplitudes[j] += Complex(0, -displaced) * response(state.modes[j]);
  }
  const MassProperties& mass = state.mass;
  const Vec3 impulse = share * blow.impulse_ns;
  state.velocity_m_s = state.velocity_m_s + (1 / mass.mass_kg) * impulse;
  const Rotation axes = Rotation::from_xyzw(mass.orientation);
  const Vec3 moment = rotated(inverse(axes), cross(blow.point_m - mass.center_of_mass_m, impulse));
  const Vec3& inertia = mass.inertia_kg_m2;
  state.spin_rad_s =
      state.spin_rad_s + rotated(axes, Vec3{moment.x / inertia.x, moment.y / inertia.y, moment.z / inertia.z});
}

// The share of a blow's impulse that has acted.
double begun_share(const Blow& blow, double elapsed_s) {
  if (blow.contact_time_s <= 0) return 1;
  const double sine = std::sin(std::numbers::pi * elapsed_s / (2 * blow.contact_time_s));
  return sine * sine;
}

}  // namespace

ModalState at_rest(std::vector<DampedMode> modes, const MassProperties& mass) {
  std::vector<Complex> amplitudes(modes.size());
  return {.modes = std::move(modes), .mass = mass, .amplitudes = std::move(amplitudes)};
}

ModeMotion motion_of(const DampedMode& mode, Complex amplitude) {
  return {amplitude.real(), (exponent_of(mode) * amplitude).real()};
}

Complex amplitude_of(const DampedMode& mode, const ModeMotion& motion) {
  if (mode.frequency_hz <= 0) return 0;
  const Complex p = exponent_of(mode);
  return {motion.coordinate, (p.real() * motion.coordinate - motion.velocity) / p.imag()};
}

void advance(ModalState& state, double seconds) {
  for (std::size_t j = 0; j < state.modes.size(); ++j)
    state.amplitudes[j] *= std::exp(exponent_of(state.modes[j]) * seconds);
}

ModalEnergy modal_energy(const ModalState& state) {
  ModalEnergy energy;
  for (std::size_t j = 0; j < state.modes.size(); ++j) {
    const auto [coordinate, velocity] = motion_of(state.modes[j], state.amplitudes[j]);
    energy.kinetic_j += velocity * velocity / 2;
    energy.strain_j += undamped_lambda(state.modes[j]) * coordinate * coordinate / 2;
  }
  return energy;
}

double rigid_energy_j(const MassProperties& mass, Vec3 velocity_m_s, Vec3 spin_rad_s) {
  const Vec3 spin = rotated(inverse(Rotation::from_xyzw(mass.orientation)), spin_rad_s);
  const Vec3& inertia = mass.inertia_kg_m2;
  return (mass.mass_kg * dot(velocity_m_s, velocity_m_s) + inertia.x * spin.x * spin.x + inertia.y * spin.y * spin.y +
          inertia.z * spin.z * spin.z) /
         2;
}

void add_blow(ModalState& state, const Blow& blow) {
  add_to(state, blow, 1,
         [&](const DampedMode& mode) { return pulse_spectrum(mode.frequency_hz, blow.contact_time_s); });
}

void add_begun_blow(ModalState& state, const Blow& blow, double elapsed_s) {
  assert(0 <= elapsed_s && elapsed_s <= blow.contact_time_s);
  add_to(state, blow, begun_share(blow, elapsed_s), [&](const DampedMode& mode) -> Complex {
    if (blow.contact_time_s <= 0) return 1;
    return pulse_response(exponent_of(mode), blow.contact_time_s, elapsed_s);
  });
}

void add_rest_of_blow(ModalState& state, const Blow& blow, double elapsed_s) {
  assert(0 <= elapsed_s && elapsed_s <= blow.contact_time_s);
  if (blow.contact_time_s <= 0) return;
  add_to(state, blow, 1 - begun_share(blow, elapsed_s), [&](const DampedMode& mode) {
    return pulse_response(-exponent_of(mode), blow.contact_time_s, blow.contact_time_s - elapsed_s);
  });
}

}  // namespace ringdown::modal
