// Makes ODE joints from descriptions. Callers hold OdeLock. This header only names ODE's types.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/ode/collider.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

struct dxBody;
struct dxJoint;
struct dxWorld;

namespace ringdown::scene {

using OdeJointPtr = std::unique_ptr<dxJoint, JointDeleter>;

// A joint of type `free` (description.h) as rows of ODE's solver.
class OdeFreeJoint {
 public:
  // Joins two bodies in their present poses; a null `other` stands for the world.
  OdeFreeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description);

  // Makes the limits and drives for a part of a step of length `part_s`, from the bodies' present poses and velocities.
  void make_rows(double part_s);

  // Returns the description with both frames moved with the bodies.
  [[nodiscard]] JointDescription now() const;

 private:
  // A frame, and the body that it is fixed to; a null body stands for the world.
  struct Frame {
    dxBody* body;
    Pose in_body;
    [[nodiscard]] Pose world() const;
  };

  // The pose of the second frame in the first one.
  struct Place {
    std::array<Vec3, 3> axes;  // of the first frame, in the world
    Vec3 point_m;              // origin of the second frame, in the world
    Vec3 way_m;                // from the first frame's origin to point_m, along the axes
    Rotation turn;
  };

  // A quantity that a limit bounds. Its rate is `scale` times the relative velocity, or spin, along a unit vector.
  struct Coordinate {
    Vec3 direction;
    double value = 0, scale = 1;
  };

  struct Softness {
    double erp = 0, cfm = 0;
  };

  [[nodiscard]] Place place() const;
  [[nodiscard]] std::optional<Coordinate> coordinate(const AxesLimit& limit, const Place& place) const;
  void add_limit(const AxesLimit& limit, const Place& place);
  void add_turn_locks(const Place& place);
  void add_drive(const AxisDrive& drive, const Place& place);

  // Add rows that bound (keep_below) or drive (pull) the velocity at the second frame's origin, or the spin of the
  // second frame relative to the first.
  void keep_below(bool turns, Vec3 direction, Vec3 point_m, double max, double cfm);
  void pull(bool turns, Vec3 direction, Vec3 point_m, double speed, double cfm, double max);
  dxJoint* add_motor(Vec3 direction);

  dxWorld* world_;
  dxBody *body_, *other_;
  JointDescription description_;
  Frame first_, second_;
  double side_ = 1;  // 1 if the second frame is fixed to `body`, else -1
  std::vector<std::size_t> turn_locks_;
  OdeJointPtr ball_;  // used if the joint locks all three displacements
  std::vector<OdeJointPtr> rows_;
  double part_s_ = 0;
  Softness hard_;
};

// A joint, with a motor for its friction or its drive if it has one, or a free joint. The bodies may be destroyed
// before the joint, which then has no effect.
class OdeJoint {
 public:
  // Joins two bodies in their present poses; a null `other` stands for the world. Anchor and axis are in world axes.
  OdeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description);

  // Returns a description that makes an identical joint between the bodies in their present poses: anchor, axis and
  // limits have moved with the bodies.
  [[nodiscard]] JointDescription now() const;

  // Sets the drive's motor and soft limits, or all rows of a free joint, for a part of a step.
  void drive(double part_s);

  // Returns true if a drive asks for a speed: the bodies of such a joint never come to rest.
  [[nodiscard]] bool keeps_moving() const;

 private:
  void add_hinge(dxWorld* world, dxBody* body, dxBody* other);
  void add_ball(dxWorld* world, dxBody* body, dxBody* other);
  void add_slider(dxWorld* world, dxBody* body, dxBody* other);
  void add_fixed(dxWorld* world, dxBody* body, dxBody* other);
  [[nodiscard]] double way() const;  // angle of a hinge or displacement of a slider [rad or m]

  JointDescription description_;
  OdeJointPtr joint_, friction_motor_;  // not used by free joints
  std::optional<OdeFreeJoint> free_;
};

}  // namespace ringdown::scene
