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

  // Makes the limits and drives for a part of a step of this length, from how the bodies lie and move now.
  void make_rows(double part_s);

  // The description with both frames where they have moved with the bodies.
  [[nodiscard]] JointDescription now() const;

 private:
  // A frame, and the body that it is fixed to; a null body stands for the world.
  struct Frame {
    dxBody* body;
    Pose in_body;
    [[nodiscard]] Pose world() const;
  };

  // How the second frame lies in the first one.
  struct Place {
    std::array<Vec3, 3> axes;  // of the first frame, in the world
    Vec3 point_m;              // origin of the second frame, in the world
    Vec3 way_m;                // from the first frame's origin to it, along the axes
    Rotation turn;
  };

  // One quantity that a limit bounds. It grows by `scale` times the relative velocity, or spin, along a unit vector.
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

  // Rows on the velocity, at the second frame's origin, or on the spin of the second frame beside the first.
  void keep_below(bool turns, Vec3 direction, Vec3 point_m, double most, double cfm);
  void pull(bool turns, Vec3 direction, Vec3 point_m, double speed, double cfm, double most);
  dxJoint* add_motor(Vec3 direction);

  dxWorld* world_;
  dxBody *body_, *other_;
  JointDescription description_;
  Frame first_, second_;
  double side_ = 1;  // 1 where the second frame is fixed to `body`, else -1
  std::vector<std::size_t> turn_locks_;
  OdeJointPtr ball_;  // where the joint holds all three axes to move along
  std::vector<OdeJointPtr> rows_;
  double part_s_ = 0;
  Softness hard_;
};

// A joint, with a motor for its friction or its drive if it has one, or a free joint. The bodies may be destroyed
// first; the joint then joins nothing.
class OdeJoint {
 public:
  // Joins two bodies in their present poses; a null `other` stands for the world. Anchor and axis are in world axes.
  OdeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description);

  // A description that makes the same joint between the bodies in their present poses: anchor, axis and limits have
  // moved with the bodies.
  [[nodiscard]] JointDescription now() const;

  // Sets the drive's motor and soft limits, and all that a free joint has, for a part of a step.
  void drive(double part_s);

  // Returns true if a drive asks for a speed: the bodies of such a joint never come to rest.
  [[nodiscard]] bool keeps_moving() const;

 private:
  void add_hinge(dxWorld* world, dxBody* body, dxBody* other);
  void add_ball(dxWorld* world, dxBody* body, dxBody* other);
  void add_slider(dxWorld* world, dxBody* body, dxBody* other);
  void add_fixed(dxWorld* world, dxBody* body, dxBody* other);
  [[nodiscard]] double way() const;  // that a hinge has turned or a slider has moved [rad or m]

  JointDescription description_;
  OdeJointPtr joint_, friction_motor_;  // of all but a free joint
  std::optional<OdeFreeJoint> free_;
};

}  // namespace ringdown::scene
