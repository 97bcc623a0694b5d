// How far a fast body may move before contacts must be looked for again, so that nothing flies through what it should
// hit. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode_collider.h"

#include <memory>

struct dxSpace;

namespace ringdown::scene {

class FlightProbe {
 public:
  FlightProbe();

  // The time for which the body may fly without looking for contacts, at most `rest_s`. [s]
  [[nodiscard]] double free_flight(const Collider& collider, double rest_s, dxSpace* space) const;

 private:
  std::unique_ptr<dxGeom, GeomDeleter> ray_,
      sweep_;  // a ray, and the box about all rays of one body
};

}  // namespace ringdown::scene
