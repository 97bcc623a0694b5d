// Finds contact points of two bodies or statics at any poses, without a simulation. [one thread at a time]
#pragma once

#include "engine/scene/contact_point.h"
#include "engine/scene/description.h"
#include "engine/scene/solid.h"

#include <memory>
#include <vector>

namespace ringdown::scene {

// A point at which the first body of a pair touches the second.
struct PosedContact {
  Vec3 point_m;
  Vec3 normal;         // unit, into the first body
  double depth_m = 0;  // how far the two overlap
};

// An axis-aligned box.
struct PosedBox {
  Vec3 low_m, high_m;
};

class PosedColliders {
 public:
  PosedColliders();
  ~PosedColliders();
  PosedColliders(const PosedColliders&) = delete;
  PosedColliders& operator=(const PosedColliders&) = delete;

  void add(BodyId id, const Solid& solid);
  void add(BodyId id, const StaticDescription& description);

  // Returns the contact points of two shapes in these poses of their centres of mass: at most some eight, the deepest
  // and those that differ most. The motion of a static is ignored. Deep overlaps of thin shapes may go unnoticed.
  std::vector<PosedContact> find(BodyId first, const Motion& of_first, BodyId second, const Motion& of_second);

  // Returns the box around a shape in this pose. That of a plane is infinite.
  PosedBox box_of(BodyId id, const Motion& motion);

  // Returns half of the thickness of the shape's thinnest part; infinite for a plane.
  [[nodiscard]] double half_thickness_m(BodyId id) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::scene
