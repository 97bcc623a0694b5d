// Makes ODE joints from descriptions. Callers hold OdeLock. This header only names ODE's types.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/ode_collider.h"
#include "engine/scene/ode_free_joint.h"

#include <memory>
#include <optional>
#include <utility>

struct dxBody;
struct dxJoint;
struct dxWorld;

namespace ringdown::scene {

using OdeJointPtr = std::unique_ptr<dxJoint, JointDeleter>;

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

  // Whether a drive asks for a speed, so that what it moves does not come to rest.
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
