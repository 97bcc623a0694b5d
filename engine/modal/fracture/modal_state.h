// The motion of a body that rings: an amplitude for each of its modes, and the body's rigid motion. [any]
//
// Whoever makes a body's events keeps such a state of it, beside what the mixer plays, in order to decide when the body
// breaks and what its pieces do then. Mode j has the damped angular frequency omega_j and the decay d_j
// (engine/modal/damping.h), and its coordinate is
//
//   q_j(t) = Re(a_j exp((i omega_j - d_j) t))  [kg^1/2 m]
//
// The state holds a_j for the present, t = 0. An impulse that gives mode j the velocity b_j = phi_j . J adds
// -i b_j / omega_j, so i omega_j a_j is an amplitude in the sense of a strike (StrikeMap::excite()). A mode of
// frequency 0 is over-damped and never moves.
//
//   ModalState state = at_rest(modes, mass);
//   advance(state, seconds_since_last_blow);
//   add_blow(state, blow);
//
// All functions cost a few complex exponentials for each mode: about 10 us for 100 modes.
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/damping.h"

#include <complex>
#include <span>
#include <vector>

namespace ringdown::modal {

struct ModalState {
  std::vector<DampedMode> modes;                 // M, of the body in its size and material
  MassProperties mass;                           // of the body in its size and material
  std::vector<std::complex<double>> amplitudes;  // M: a_j [kg^1/2 m]
  Vec3 velocity_m_s;                             // of the centre of mass, along the object's axes
  Vec3 spin_rad_s;                               // along the object's axes
};

ModalState at_rest(std::vector<DampedMode> modes, const MassProperties& mass);

// One mode's coordinate and its derivative at the present.
struct ModeMotion {
  double coordinate = 0;  // q [kg^1/2 m]
  double velocity = 0;    // q' [kg^1/2 m/s]
};
ModeMotion motion_of(const DampedMode& mode, std::complex<double> amplitude);
std::complex<double> amplitude_of(const DampedMode& mode, const ModeMotion& motion);  // 0 for an over-damped mode

// Moves the present to a time that is `seconds` later (or earlier, if negative). The rigid motion stays.
void advance(ModalState& state, double seconds);

// Energy of the modes [J]; the rigid motion has none of it.
struct ModalEnergy {
  double kinetic_j = 0, strain_j = 0;
  [[nodiscard]] double total_j() const { return kinetic_j + strain_j; }
};
ModalEnergy modal_energy(const ModalState& state);

// Energy of a rigid motion [J], with the spin along the object's axes.
double rigid_energy_j(const MassProperties& mass, Vec3 velocity_m_s, Vec3 spin_rad_s);

// A force at a point: a half sine of `contact_time_s` >= 0 whose integral is `impulse_ns`. Duration 0 is an ideal
// impulse.
struct Blow {
  std::span<const double> modal_impulse;  // M: phi_j . impulse [J^1/2], with the body's own shapes
  Vec3 point_m, impulse_ns;               // in the object's frame
  double contact_time_s = 0;
};

// Adds a whole blow as the mixer does: at the pulse's centre, weighed by the pulse's spectrum
// (engine/modal/hearing/contact_pulse.h).
void add_blow(ModalState& state, const Blow& blow);

// These two divide a blow at `elapsed_s` after the force began, 0 to contact_time_s; the peak of the force is at half
// of the contact time. The present is that moment. The first function adds what the force has done until then, with
// the damping, exactly; the second adds what the force will do from then on, as seen at the present, so that from the
// force's end on the state is exact. Together they are the whole blow. An ideal impulse belongs to the first.
//
// If a body breaks at the peak of the force, its state before the break takes add_begun_blow(), and the state of the
// piece that lies under the blow takes add_rest_of_blow(), with the piece's own modal_impulse. A scene whose striker
// goes on to touch the piece makes a new contact of it instead, and must not add the rest here as well.
void add_begun_blow(ModalState& state, const Blow& blow, double elapsed_s);
void add_rest_of_blow(ModalState& state, const Blow& blow, double elapsed_s);

}  // namespace ringdown::modal
