// The contacts of pairs of bodies by their surfaces, kept from one part of a step to the next. While two bodies stay
// where they are in relation to each other, the features that touch stay the same, and only their depths are found
// anew; the search is made again when the two have moved. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"
#include "engine/scene/surface_contacts.h"

#include <map>
#include <span>
#include <utility>
#include <vector>

struct dContactGeom;

namespace ringdown::scene {

class SurfacePairs {
 public:
  // Whether contacts of the two shapes are found by their surfaces: not those of spheres, planes, and two boxes.
  [[nodiscard]] static bool covers(const Collider& one, const Collider& two);

  // Stores the contacts of the two bodies in `room` and returns their number. Normals point into the first. `part_s` is
  // how long the bodies have moved since contacts were last looked for: features may be that much deeper in each other.
  int find(const Collider& first, const Collider& second, double part_s, std::span<dContactGeom> room);

  void end_part();         // forgets pairs that were not looked at since the last call
  void forget(BodyId id);  // must be called when a body changes its shape

 private:
  struct Kept {
    RelativePose pose;
    std::vector<SurfaceContact> contacts;  // in the second's frame, at that pose
    bool used = false;
  };
  std::map<std::pair<BodyId, BodyId>, Kept> kept_;
};

}  // namespace ringdown::scene
