#include "engine/scene/ode/parting.h"

#include <ode/ode.h>

#include <algorithm>

namespace ringdown::scene {
namespace {

// Cosine of the largest angle between normals of one direction.
constexpr double kOneDirection = 0.7;

// Meshes overlap by up to this much at rest.
constexpr double kAtRest_m = 1e-4;

// The way out of a wall, by its thickness: walls may be met aslant.
constexpr double kWayOut = 2;

bool is_mesh(const Collider& collider) { return dGeomGetClass(collider.shape.geom.get()) == dTriMeshClass; }

BodyPair pair_of(const Overlap& overlap) { return std::minmax(overlap.body->id, overlap.other->id); }

bool are_meshes(const Overlap& overlap) { return is_mesh(*overlap.body) && is_mesh(*overlap.other); }

}  // namespace

void Partings::limit(std::span<Overlap> overlaps, double part_s) {
  for (const Overlap& overlap : overlaps) {
    if (!are_meshes(overlap)) continue;
    Parting& pair = pairs_[pair_of(overlap)];
    const Vec3 normal = overlap.point->normal;
    if (!pair.touches) {
      pair.touches = true;
      pair.differ = false;
      pair.normal = normal;
      pair.deepest_m = 0;
      const double wall_m = std::min(overlap.body->shape.surface.thickness_m, overlap.other->shape.surface.thickness_m);
      pair.limit_s = kWayOut * wall_m * part_s / overlap.max_m;
    }
    pair.deepest_m = std::max(pair.deepest_m, overlap.point->depth_m);
    if (dot(normal, pair.normal) < kOneDirection) pair.differ = true;
  }
  pairs_.erase_if([&](const BodyPair&, Parting& pair) {
    if (!pair.touches) return true;
    pair.touches = false;
    const bool tries = pair.differ && pair.deepest_m > kAtRest_m;
    pair.tried_s = std::clamp(pair.tried_s + (tries ? part_s : -part_s), 0.0, pair.limit_s + part_s);
    return false;
  });
  for (Overlap& overlap : overlaps) {
    if (!are_meshes(overlap)) continue;
    const Parting& pair = pairs_[pair_of(overlap)];
    if (pair.differ && pair.tried_s > pair.limit_s) overlap.max_m = 0;
  }
}

}  // namespace ringdown::scene
