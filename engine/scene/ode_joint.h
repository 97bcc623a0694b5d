// From plain joints to ODE's. Callers hold OdeLock. ODE's types are only named here.
#pragma once

#include "engine/scene/description.h"

#include <memory>
#include <utility>

struct dxBody;
struct dxJoint;
struct dxWorld;

namespace ringdown::scene {

struct JointDeleter {
  void operator()(dxJoint* joint) const;
};
using OdeJointPtr = std::unique_ptr<dxJoint, JointDeleter>;

// A joint, and the motor that resists its turning where it has friction. The bodies may go first: the joint then holds
// nothing.
class OdeJoint {
 public:
  // Joins the bodies as they are now; a null `other` is the world. Anchor and axis of the description are in the world.
  OdeJoint(dxWorld* world, dxBody* body, dxBody* other, const JointDescription& description);

  // What would make the same joint again between the bodies as they are now: anchor, axis and limits have moved along.
  [[nodiscard]] JointDescription now() const;

 private:
  void add_hinge(dxWorld* world, dxBody* body, dxBody* other);
  void add_ball(dxWorld* world, dxBody* body, dxBody* other);

  JointDescription description_;
  OdeJointPtr joint_, brake_;
};

}  // namespace ringdown::scene
