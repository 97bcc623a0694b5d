#include "engine/scene/ode/surface_pairs.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// A part of the thinner body's thickness up to which bodies may overlap at rest.
constexpr double kDeepest = 0.2;

// Contacts are reused while two bodies have moved by less than this relative to each other: a new contact could be no
// nearer than SurfacePairs::kMargin_m less this.
constexpr double kSame_m = 3e-5;

// A pair without contacts is searched again after any motion, but not where a part is solved again from its beginning.
constexpr double kSamePlace_m = 1e-12;

struct GeomPose {
  Matrix3 rotation;
  Vec3 position;
};

GeomPose pose_of(dxGeom* geom) {
  const dReal* r = dGeomGetRotation(geom);
  return {{{{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}}}, to_vec3(dGeomGetPosition(geom))};
}

RelativePose relative(const GeomPose& first, const GeomPose& second) {
  const Matrix3 back = transpose(second.rotation);
  return {product(back, first.rotation), back * (first.position - second.position)};
}

// The farthest way between two poses of any point within `reach_m` of the origin, or more.
double way_between(const RelativePose& a, const RelativePose& b, double reach_m) {
  double turn2 = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) turn2 += (a.rotation[i][j] - b.rotation[i][j]) * (a.rotation[i][j] - b.rotation[i][j]);
  }
  return length(a.position - b.position) + reach_m * std::sqrt(turn2);
}

double fastest_m_s(const Collider& collider) {
  const Motion motion = collider.motion();
  return length(motion.velocity_m_s) + collider.shape.surface.reach_m * length(motion.spin_rad_s);
}

}  // namespace

bool SurfacePairs::covers(const Collider& one, const Collider& two) {
  const auto has_surface = [](const Collider& c) { return !c.shape.surface.corners.items.empty(); };
  const auto is_box = [](const Collider& c) { return dGeomGetClass(c.shape.geom.get()) == dBoxClass; };
  return has_surface(one) && has_surface(two) && !(is_box(one) && is_box(two));
}

int SurfacePairs::find(const Collider& first, const Collider& second, double part_s, std::span<dContactGeom> room) {
  const Surface &one = first.shape.surface, &two = second.shape.surface;
  const GeomPose at = pose_of(first.shape.geom.get()), base = pose_of(second.shape.geom.get());
  const RelativePose pose = relative(at, base);
  const auto [entry, is_new] = kept_.try_emplace({first.id, second.id});
  Kept& kept = entry->second;
  kept.used = true;
  const double same_m = kept.contacts.empty() ? kSamePlace_m : kSame_m;
  if (is_new || way_between(kept.pose, pose, one.reach_m) > same_m) {
    const Motion of_first = first.motion(), of_second = second.motion();
    DepthLimit limit;
    limit.standing_m = kDeepest * std::min(one.thickness_m, two.thickness_m);
    limit.max_m = limit.standing_m + 2 * part_s * (fastest_m_s(first) + fastest_m_s(second));
    limit.came_in_m = [&](Vec3 point, Vec3 normal) {
      const Vec3 world_m = base.position + base.rotation * point;
      const Vec3 approach = of_second.velocity_at(world_m) - of_first.velocity_at(world_m);
      return 2 * part_s * std::max(dot(approach, base.rotation * normal), 0.0);
    };
    kept.pose = pose;
    kept.contacts.clear();
    find_surface_contacts(one, two, pose, kMargin_m, limit, kept.contacts);
  }
  const Matrix3 back = transpose(kept.pose.rotation);
  int count = 0;
  for (const SurfaceContact& contact : kept.contacts) {
    if (count == static_cast<int>(room.size())) break;
    const Vec3 on_first = contact.point - contact.depth_m * contact.normal;
    const Vec3 now = pose.position + pose.rotation * (back * (on_first - kept.pose.position));
    dContactGeom& geom = room[count++];
    geom = {};
    copy(base.position + base.rotation * contact.point, geom.pos);
    copy(base.rotation * contact.normal, geom.normal);
    geom.depth = contact.depth_m - dot(contact.normal, now - on_first);
    geom.g1 = first.shape.geom.get();
    geom.g2 = second.shape.geom.get();
  }
  return count;
}

void SurfacePairs::end_part() {
  std::erase_if(kept_, [](const auto& entry) { return !entry.second.used; });
  for (auto& [pair, kept] : kept_) kept.used = false;
}

void SurfacePairs::forget(BodyId id) {
  std::erase_if(kept_, [id](const auto& entry) { return entry.first.first == id || entry.first.second == id; });
}

}  // namespace ringdown::scene
