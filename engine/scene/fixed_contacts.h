// The exact solution for one body that touches only what cannot move: the impulses of all its contact points in one
// step, by the same equations as ODE's exact solver, at a fraction of the cost of building joints for it. Free of any
// physics engine. [any thread]
#pragma once

#include "engine/scene/rotation.h"

#include <cstddef>
#include <optional>
#include <span>

namespace ringdown::scene {

// The most contact points that solve_fixed_contacts() takes.
inline constexpr std::size_t kMaxFixedContacts = 8;

// How often friction is bounded anew by the last solution's impulses, and the relative difference at which that ends.
inline constexpr int kMaxFrictionRounds = 20;
inline constexpr double kFrictionAgrees = 2e-4;

// The bound of a contact's friction, which should be the coefficient times the normal impulse that it leads to. More
// friction may make that impulse so much smaller that a bound taken from the last solution swings for ever; so once
// one bound was too low and another too high, the next one is found between them, by the Illinois method.
class FrictionBound {
 public:
  [[nodiscard]] double value() const { return bound_; }

  // Chooses the next bound. `asked` is what the solution with the present bound asks for, or, at first, one with
  // another bound. Returns by how much it differs from the present one.
  double meet(double asked);

 private:
  struct Tried {
    double bound, lacks;
  };
  double bound_ = 0;
  bool begun_ = false, was_too_low_ = false;  // `was`: the bound before
  std::optional<Tried> low_, high_;
};

struct FixedContact {
  Vec3 arm_m;             // from the body's centre of mass to the point
  Vec3 normal;            // unit, into the body
  Vec3 along;             // unit, across the normal: friction acts along it and across it, each up to its bound
  double wanted_m_s = 0;  // the least speed along the normal at the end of the step
  double friction = 0;    // coefficient
};

// The body, with the velocities that it would have at the end of the step without its contacts. World axes.
struct FreeBody {
  double inverse_mass = 0;
  Matrix3 inverse_inertia{};
  Vec3 velocity_m_s, spin_rad_s;
};

// Finds the impulse that the body receives at each of at most kMaxFixedContacts contact points. Normal impulses never
// pull. `softness` [1/kg] is the speed by which a contact gives way per impulse. Friction is bounded by the coefficient
// times the normal impulse that there would be without friction, or, where the body `lands`, times the solution's own
// normal impulse, if that can be found in kMaxFrictionRounds rounds. Returns false, in rare degenerate cases, without a
// solution.
bool solve_fixed_contacts(const FreeBody& body, std::span<const FixedContact> contacts, double softness, bool lands,
                          std::span<Vec3> impulses_ns);

// A unit vector across a unit normal: the one that ODE takes where nothing slides.
Vec3 any_across(Vec3 normal);

}  // namespace ringdown::scene
