// Finds contacts of pairs of bodies by their surfaces, and keeps them from one part of a step to the next. While the
// relative pose of two bodies stays nearly unchanged, the touching features are kept and only their depths are updated;
// when the pose has changed, the search is repeated. Callers must hold OdeLock.
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
  // Surfaces that are this close touch, so that a resting body does not lose and find its contacts.
  static constexpr double kMargin_m = 1e-4;

  // Returns whether the two shapes' contacts are found by surfaces: not for spheres, planes, and two boxes.
  [[nodiscard]] static bool covers(const Collider& one, const Collider& two);

  // Stores the contacts of the two bodies in `room` and returns their number. Normals point into the first body.
  // `part_s` is the time that the bodies have moved since the last search, in which features may have moved deeper into
  // each other.
  int find(const Collider& first, const Collider& second, double part_s, std::span<dContactGeom> room);

  void end_part();         // forgets pairs that were not looked at since the last call
  void forget(BodyId id);  // must be called when a body changes its shape

 private:
  struct Kept {
    RelativePose pose;
    std::vector<SurfaceContact> contacts;  // in the second body's frame, at the stored pose
    bool used = false;
  };
  std::map<std::pair<BodyId, BodyId>, Kept> kept_;
};

}  // namespace ringdown::scene
