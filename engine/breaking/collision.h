// A collision of a body that bends with another one that does not, computed in time. [any]
//
// Rigid bodies exchange an impulse that takes no account of how a body gives way. Here the contact is a spring between
// the other body and the surface, which moves with the body's rigid motion and its modes, so duration, impulse and the
// energy of the modes follow from the stiffness of the contact and the mass that each side opposes. Forces act along
// the normals. Kinetic energy, energy of the modes and of the springs never grow together (engine/contact/impact.h).
//
//   Collision collision(map, material, state_at_the_first_touch, meeting);
//   while (!collision.is_over()) collision.step();
//
// Cost: a microsecond for each step and 100 modes; a collision has some hundreds of steps.
#pragma once

#include "engine/contact/network.h"
#include "engine/modal/fracture/modal_state.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/strike_map.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::breaking {

// A point at which the two bodies meet, in the frame and size of the body that bends.
struct MeetingPoint {
  Vec3 point_m;
  Vec3 normal;             // unit, into the body
  double closing_m_s = 0;  // of the rigid motions, before the collision
  double gap_m = 0;        // between the surfaces when the first point touches, >= 0
  contact::ImpactLaw law;
};

struct Meeting {
  std::vector<MeetingPoint> points;  // 1 to contact::kMaxContacts
  // N x N: how much an impulse of 1 N s at point j slows the closing at point i through the other body's motion [1/kg].
  // Empty: the other body does not move.
  std::vector<double> other_per_kg;
  // The distance between points that stand for a line or a face, which bear a force that is spread: 0 for points that
  // bear alone.
  double spacing_m = 0;
};

class Collision {
 public:
  // `before` is the body's state when the first point touches; its modes may ring already. Only modes whose frequency
  // is above 0 move.
  Collision(const modal::StrikeMap& map, const modal::MaterialScale& material, const modal::ModalState& before,
            const Meeting& meeting);
  Collision(const Collision&) = delete;
  Collision& operator=(const Collision&) = delete;

  void step();
  [[nodiscard]] double step_s() const { return step_s_; }

  // The state of the body now. Its rigid motion is what the collision has added.
  [[nodiscard]] const modal::ModalState& state() const { return state_; }
  [[nodiscard]] double time_s() const { return time_s_; }         // since the first touch
  [[nodiscard]] double force_n() const { return force_n_; }       // of all points together, in the last step
  [[nodiscard]] double impulse_ns() const { return pushed_ns_; }  // sum of the magnitudes at all points until now

  // Returns true once the surfaces have been apart for kApart_s, and in any case after kMax_s. Bending bodies touch
  // several times.
  [[nodiscard]] bool is_over() const;
  static constexpr double kApart_s = 0.5e-3, kMax_s = 20e-3;

 private:
  void push(std::span<const double> force_n);

  std::vector<MeetingPoint> points_;
  modal::ModalState state_;
  std::vector<Vec3> rigid_turn_;  // of each point: what spin an impulse of 1 N s along its normal gives the body
  std::vector<double> per_kg_;    // N x N, of both bodies' rigid motion
  std::vector<double> shapes_;    // N x M: phi_m . normal [kg^-1/2]
  std::vector<double> turn_re_, turn_im_, push_re_,
      push_im_;                      // M: one step without force; what 1 N^(1) for a step adds
  std::vector<double> closing_m_s_;  // N, of the rigid motions
  std::vector<contact::Contact> contacts_;
  contact::Network network_;
  double step_s_ = 0, time_s_ = 0, force_n_ = 0, pushed_ns_ = 0, last_touch_s_ = 0;
};

}  // namespace ringdown::breaking
