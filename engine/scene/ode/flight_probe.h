// How far a fast body may move or turn before contacts must be looked for again, so that nothing flies through what it
// should hit. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

#include <memory>

struct dxSpace;

namespace ringdown::scene {

class FlightProbe {
 public:
  FlightProbe();

  // The time for which the body may fly without looking for contacts, at most `rest_s`. [s]
  [[nodiscard]] double free_flight(Collider& collider, double rest_s, dxSpace* space) const;

 private:
  void set_box(Vec3 from_m, Vec3 way_m, double radius_m) const;

  std::unique_ptr<dxGeom, GeomDeleter> ray_, box_;  // a ray, and the box about all that one body may reach
};

}  // namespace ringdown::scene
