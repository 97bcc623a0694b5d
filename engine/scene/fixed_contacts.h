// Exact contact solution for one body that touches only immovable things: the impulses of all its contact points in one
// step, by the same equations as ODE's exact solver, at a fraction of the cost of building joints for it. Free of any
// physics engine. [any thread]
#pragma once

#include "engine/scene/rotation.h"

#include <cstddef>
#include <optional>
#include <span>

namespace ringdown::scene {

// Maximum number of contact points that solve_fixed_contacts() accepts.
inline constexpr std::size_t kMaxFixedContacts = 8;

// Maximum number of rounds in which the friction bound is recomputed from the last solution's impulses, and the
// relative difference at which the rounds end.
inline constexpr int kMaxFrictionRounds = 20;
inline constexpr double kFrictionAgrees = 2e-4;

// Friction bound of one contact. The bound should be the coefficient times the normal impulse in the solution that uses
// that bound. More friction may reduce the normal impulse so much that taking each bound from the last solution
// oscillates for ever. So once one bound was too low and another too high, the next is chosen between them by the
// Illinois method.
class FrictionBound {
 public:
  [[nodiscard]] double value() const { return bound_; }

  // Chooses the next bound. `asked` is the bound that follows from the last solution (in the first call, from a
  // solution with any other bound). Returns how much `asked` differs from the present bound.
  double meet(double asked);

 private:
  struct Tried {
    double bound, lacks;
  };
  double bound_ = 0;
  bool begun_ = false, was_too_low_ = false;  // was_too_low_ refers to the bound before the present one
  std::optional<Tried> low_, high_;
};

struct FixedContact {
  Vec3 arm_m;             // from the body's centre of mass to the contact point
  Vec3 normal;            // unit, into the body
  Vec3 along;             // unit, orthogonal to the normal; friction acts along it and across it
  double wanted_m_s = 0;  // minimum speed along the normal at the end of the step
  double friction = 0;    // coefficient
};

// A body with the velocities that it would have at the end of the step without its contacts. World axes.
struct FreeBody {
  double inverse_mass = 0;
  Matrix3 inverse_inertia{};
  Vec3 velocity_m_s, spin_rad_s;
};

// Finds the impulse at each of at most kMaxFixedContacts contact points of the body. Normal impulses never pull.
// `softness` [1/kg] is the speed by which a contact yields per impulse. Friction is bounded by the coefficient times a
// normal impulse: for a body that `lands`, the solution's own normal impulse if kMaxFrictionRounds rounds find it;
// otherwise the normal impulse without friction. Returns false, without a solution, in rare degenerate cases.
bool solve_fixed_contacts(const FreeBody& body, std::span<const FixedContact> contacts, double softness, bool lands,
                          std::span<Vec3> impulses_ns);

// A unit vector orthogonal to a unit normal: the one that ODE uses for contacts without sliding.
Vec3 any_across(Vec3 normal);

}  // namespace ringdown::scene
