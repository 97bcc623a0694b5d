// Computes how far a fast body may move or turn before contacts must be searched again, so that nothing flies through
// an obstacle. Callers must hold OdeLock.
#pragma once

#include "engine/scene/fresh_pairs.h"
#include "engine/scene/ode/collider.h"

#include <memory>

struct dxSpace;

namespace ringdown::scene {

class FlightProbe {
 public:
  FlightProbe();

  // Returns the time for which the body may fly without a search for contacts, at most `rest_s` [s]. A piece
  // of a broken body may pass through another one: thin pieces that fly past each other would make the step costly.
  [[nodiscard]] double free_flight(Collider& collider, double rest_s, dxSpace* space, const FreshPairs& fresh) const;

 private:
  void set_box(Vec3 from_m, Vec3 way_m, double radius_m) const;

  std::unique_ptr<dxGeom, GeomDeleter> ray_, box_;  // a ray, and a box about everything that a body may reach
};

}  // namespace ringdown::scene
