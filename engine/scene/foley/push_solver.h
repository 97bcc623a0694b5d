// Divides what acted on bodies around the frames of an animation among the contacts that they had. [any thread]
//
// The unknowns are impulses at contact points: positive along their normals, and across them at most the friction's
// share of that. They are chosen so that together they explain the pushes of all bodies around all frames as well as
// they can, in the kinetic energy of what remains unexplained, by projected Gauss-Seidel steps. So an impulse between
// two bodies must fit what happened to both of them, and what no contact can explain (a hand, a motor, an animator) is
// left out.
//
// A blow between two frames has one impulse, of which each of the frames shows a share that its moment decides
// (keyed_motion.h). Blows are fitted first, and their moments with them, because the impulses of lasting contacts,
// which are free in each frame, could explain everything in their place.
#pragma once

#include "engine/base/rotation.h"
#include "engine/scene/foley/keyed_motion.h"

#include <array>
#include <cstddef>
#include <vector>

namespace ringdown::scene {

// A body around one frame: first the changes of its speed and its spin (KeyedMotion::push), after the solution what of
// them is unexplained.
struct PushedBody {
  double inverse_mass = 0;
  Matrix3 inverse_inertia{};  // world axes; zero, as the mass: immovable
  Vec3 speed_m_s, spin_rad_s;
};

// A contact of the interval that begins with `frame`.
struct PushContact {
  std::size_t frame = 0;
  double before = 1, after = 0;       // shares of the impulse that the frame and the next one show
  std::size_t first = 0, second = 0;  // bodies
  Vec3 first_arm_m, second_arm_m;     // from the centres of mass, world axes
  Vec3 normal;                        // into the first body
  double friction = 0;
  Vec3 impulse_ns;  // result: received by the first body
};

class PushSystem {
 public:
  PushSystem(std::size_t frames, std::size_t bodies) : bodies_(bodies), slots_(frames * bodies), contacts_of_(frames) {}

  PushedBody& body(std::size_t frame, std::size_t number) { return slots_[frame * bodies_ + number]; }

  // Add the points of a blow at the share `s` of an interval, where geometry sees it, or of a lasting contact around
  // one frame. Both must be frames of the system. Return the number of the first contact.
  std::size_t add_blow(std::vector<PushContact> points, double s);
  std::size_t add_load(std::vector<PushContact> points);

  void solve();

  [[nodiscard]] const PushContact& contact(std::size_t number) const { return contacts_[number]; }

 private:
  struct Moment {  // of a blow
    std::size_t first = 0, count = 0;
    double seen = 0;
  };
  struct Yield {  // of a contact, along its normal and two ways across it
    std::array<Vec3, 3> ways;
    std::array<double, 3> inverse_masses;  // with the shares of both frames
  };
  std::size_t add(std::vector<PushContact> points);
  void prepare(std::size_t number);
  void sweep_all(bool forward, bool loads);
  void sweep(std::size_t frame, bool loads);
  double improve(std::size_t number);
  void apply(PushContact& contact, Vec3 impulse_ns, double before, double after);
  [[nodiscard]] Vec3 unexplained_m_s(const PushContact& contact, std::size_t frame) const;
  [[nodiscard]] double inverse_mass_at(const PushContact& contact, std::size_t frame, Vec3 way) const;
  void move(const Moment& moment);

  std::size_t bodies_;
  std::vector<PushedBody> slots_;
  std::vector<PushContact> contacts_;
  std::vector<Yield> yields_;  // of the contacts
  std::vector<bool> is_load_;
  std::vector<Moment> moments_;
  std::vector<std::vector<std::size_t>> contacts_of_;  // of each frame
};

}  // namespace ringdown::scene
