// The motion of one body as keyframes tell it: a pose in every frame, the impulses that must have acted on the body
// between the frames, and the poses between them. [any thread]
//
// The second difference of the positions x of the centre of mass, with the frames' interval h, is the mean of the
// acceleration a around a frame, weighted by a triangle over the two intervals beside the frame:
//
//   x(k+1) - 2 x(k) + x(k-1) = h^2 integral a(t) max(0, 1 - |t - k h| / h) dt / h
//
// So m (x(k+1) - 2 x(k) + x(k-1)) / h - m g h is the impulse of all contacts with these weights, however short they
// are. A blow at the share s of an interval gives the share 1 - s of its impulse to the frame before and s to the frame
// after: the two frames tell the blow's impulse and its time, exactly where nothing else acts on the body meanwhile.
// The angular momentum is treated in the same way. In each interval it is that of the free turning motion that leads
// from one frame's rotation to the next one's.
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/foley/limits.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/solid.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace ringdown::scene {

// An impulse [N s] and the moment of impulse about the centre of mass [N m s], world axes.
struct Push {
  Vec3 linear_ns, angular_nms;
};

class KeyedMotion {
 public:
  // A body that never moves, with its centre of mass in `motion`; motion of a static: rest at the origin.
  explicit KeyedMotion(const Motion& motion) : rest_(motion) {}

  // A body that follows the path, whose poses are those of the object's frame. `from` is the first frame in which the
  // body is in the scene.
  KeyedMotion(const MotionPath& path, const RigidMass& mass, Vec3 gravity_m_s2, std::size_t from,
              const FoleyLimits& limits);

  [[nodiscard]] bool moves() const { return !frames_.empty(); }

  // Returns whether the body is in the scene, and moves steadily, from frame `k` to the next one.
  [[nodiscard]] bool has_interval(std::size_t k) const;

  // Returns what acted on the body around frame `k`; nothing for a body that never moves, and where the body jumps.
  [[nodiscard]] Push push(std::size_t k) const;

  // Returns whether the body turns so far from one frame to the next, beside frame k, that it may as well have turned
  // the other way round. Nothing is then known of its angular momentum.
  [[nodiscard]] bool turns_fast(std::size_t k) const;

  [[nodiscard]] double inverse_mass() const { return moves() ? 1 / mass_.mass_kg : 0; }
  [[nodiscard]] Matrix3 inverse_inertia(std::size_t k) const;  // world axes, in frame k; zero if it never moves

  // Returns the body's motion at the share `s`, 0 to 1, of interval k: on the straight way between both frames, or as
  // it would go on from the interval before, or as it must have come to the interval after, both without contacts.
  //
  // The mean velocity of an interval differs from that at its end by half of the fall in an interval, and by the part
  // of `push` at its end that comes from contacts of this very interval. Until explain() has told that part, a body
  // that something acts on is taken to keep its velocity.
  [[nodiscard]] Motion between(std::size_t k, double s) const;
  [[nodiscard]] Motion onward(std::size_t k, double s) const;
  [[nodiscard]] Motion backward(std::size_t k, double s) const;

  // Returns the motion at frame `k` of a body that comes to the next frame without contacts, for a simulation whose
  // steps move bodies by the velocity at their end.
  [[nodiscard]] Motion free_start(std::size_t k, double step_s) const;

  // Forgets what was explained, but keeps to explanations from now on.
  void begin_explaining();
  // Adds what contacts of interval `k` contribute to the pushes around the frames before and after the interval.
  void explain(std::size_t k, const Push& before, const Push& after);

  [[nodiscard]] std::size_t jumps() const { return jumps_; }

 private:
  struct Interval {
    Vec3 velocity_m_s;    // mean, of the centre of mass
    Vec3 momentum_nms;    // angular, about the centre of mass, world axes
    bool steady = false;  // false: the body is not in the scene yet, or jumps
    Push before, after;   // of its contacts, around the frames before and after
  };
  [[nodiscard]] Matrix3 turned_inertia(const Rotation& rotation) const;
  [[nodiscard]] Rotation turn(const Rotation& from, Vec3 momentum_nms, double time_s) const;
  [[nodiscard]] Vec3 spin(const Rotation& rotation, Vec3 momentum_nms) const;
  [[nodiscard]] Vec3 momentum_between(const Rotation& from, const Rotation& to) const;
  [[nodiscard]] bool is_free(std::size_t k) const;
  void find_jumps(double radius_m, const FoleyLimits& limits);

  Motion rest_;
  RigidMass mass_;
  Matrix3 inverse_inertia_{};  // object frame
  Vec3 gravity_m_s2_;
  double every_s_ = 0, jitter_m_s_ = 0;
  std::vector<Pose> frames_;  // of the centre of mass
  std::vector<Interval> intervals_;
  std::size_t jumps_ = 0;
  bool explained_ = false;
};

}  // namespace ringdown::scene
