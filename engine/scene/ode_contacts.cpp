#include "engine/scene/ode_contacts.h"

#include "engine/scene/collider.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>

namespace ringdown::scene {
namespace {

// Of meshes: the cosine between normals that agree, and how far meshes at rest overlap.
constexpr double kAgree = 0.7, kRestOverlap_m = 1e-4;

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// Moves the deepest contact to the front, then each time the one farthest from those already chosen.
std::size_t choose_contacts(std::span<dContactGeom> found) {
  if (found.size() <= kMaxContactsPerPair) return found.size();
  std::ranges::iter_swap(found.begin(), std::ranges::max_element(found, {}, &dContactGeom::depth));
  for (std::size_t chosen = 1; chosen < kMaxContactsPerPair; ++chosen) {
    const auto distance = [&](const dContactGeom& candidate) {
      double nearest = dInfinity;
      for (const dContactGeom& taken : found.first(chosen)) {
        nearest = std::min(nearest, length(to_vec3(candidate.pos) - to_vec3(taken.pos)));
      }
      return nearest;
    };
    std::ranges::iter_swap(found.begin() + static_cast<std::ptrdiff_t>(chosen),
                           std::ranges::max_element(found.subspan(chosen), {}, distance));
  }
  return kMaxContactsPerPair;
}

// A contact for every corner of the box below the plane, with the normal out of the plane. ODE itself finds at most
// four; for a thin plate that overlaps the plane these are the corners of one edge, about which the plate then rocks.
int box_on_plane(dxGeom* box, dxGeom* plane, std::span<dContactGeom> found) {
  dVector3 size;
  dVector4 half_space;
  dGeomBoxGetLengths(box, size);
  dGeomPlaneGetParams(plane, half_space);
  const Vec3 normal = to_vec3(half_space);
  int count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return (corner >> axis & 1 ? 0.5 : -0.5) * size[axis]; };
    dVector3 point;
    dGeomGetRelPointPos(box, side(0), side(1), side(2), point);
    const double depth = half_space[3] - dot(normal, to_vec3(point));
    if (depth < 0) continue;
    dContactGeom& contact = found[count++];
    contact = {};
    std::copy_n(point, 3, contact.pos);
    std::copy_n(half_space, 3, contact.normal);
    contact.depth = depth;
    contact.g1 = box;
    contact.g2 = plane;
  }
  return count;
}

PosedFaces posed_faces(dxGeom* geom) {
  const dReal* r = dGeomGetRotation(geom);
  const Matrix3 turn{{{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}}};
  return {static_cast<const Collider*>(dGeomGetData(geom))->shape.faces, turn, to_vec3(dGeomGetPosition(geom))};
}

// ODE finds one contact point of two hulls. Where faces of the hulls lie on each other, replaces it by the corners of
// the polygon that the faces share; returns the number of points.
int spread(std::span<dContactGeom> found) {
  const dContactGeom one = found.front();
  const FaceContact shared = share_of_faces(posed_faces(one.g1), posed_faces(one.g2), to_vec3(one.normal));
  const std::size_t count = std::min(shared.points.size(), found.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [point, depth] = shared.points[k];
    found[k] = one;
    found[k].depth = depth;
    for (int axis = 0; const double part : {point.x, point.y, point.z}) found[k].pos[axis++] = part;
    for (int axis = 0; const double part : {shared.normal.x, shared.normal.y, shared.normal.z}) {
      found[k].normal[axis++] = part;
    }
  }
  return std::max(static_cast<int>(count), 1);
}

bool are_hulls(int one, int two) {
  const bool solid = (one == dConvexClass || one == dBoxClass) && (two == dConvexClass || two == dBoxClass);
  return solid && (one == dConvexClass || two == dConvexClass);  // of two boxes ODE finds all contacts
}

Vec3 velocity_at(dxGeom* geom, const dReal* point) {
  dxBody* body = dGeomGetBody(geom);
  if (!body) return {};
  dVector3 velocity;
  dBodyGetPointVel(body, point[0], point[1], point[2], velocity);
  return to_vec3(velocity);
}

// Removes false contacts of two meshes. ODE tests every pair of triangles, and gives each contact the shortest way out
// of the other triangle's plane: for two plates on each other also sideways ways, as long as the plates are wide. A
// contact is false if a contact within its own depth has less than half of that depth. It is also false if its normal
// disagrees with that of the shallowest contact, and it is deeper than that contact and the bodies' approach since the
// last step can explain.
std::size_t drop_false(std::span<dContactGeom> found, double part_s) {
  if (found.empty()) return 0;
  const dContactGeom least = *std::ranges::min_element(found, {}, &dContactGeom::depth);
  const auto is_false = [&](const dContactGeom& contact) {
    const bool shallower_nearby = std::ranges::any_of(found, [&](const dContactGeom& better) {
      const Vec3 way = to_vec3(better.pos) - to_vec3(contact.pos);
      return better.depth < 0.5 * contact.depth && dot(way, way) <= contact.depth * contact.depth;
    });
    if (shallower_nearby) return true;
    const Vec3 normal = to_vec3(contact.normal);
    if (dot(normal, to_vec3(least.normal)) > kAgree) return false;
    const Vec3 apart = velocity_at(contact.g1, contact.pos) - velocity_at(contact.g2, contact.pos);
    const double came_in_m = 2 * part_s * std::max(-dot(apart, normal), 0.0);
    return contact.depth > 2 * least.depth + kRestOverlap_m + came_in_m;
  };
  std::array<bool, kMaxContactsFound> out{};
  for (std::size_t k = 0; k < found.size(); ++k) out[k] = is_false(found[k]);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!out[k]) found[kept++] = found[k];
  }
  return kept;
}

int find_all(dxGeom* first, dxGeom* second, std::span<dContactGeom> found, double part_s) {
  const int one = dGeomGetClass(first), two = dGeomGetClass(second);
  if (one == dBoxClass && two == dPlaneClass) return box_on_plane(first, second, found);
  if (one != dPlaneClass || two != dBoxClass) {
    const int count = dCollide(first, second, kMaxContactsFound, found.data(), sizeof(dContactGeom));
    if (count > 0 && are_hulls(one, two)) return spread(found);
    if (one == dTriMeshClass && two == dTriMeshClass) {
      return static_cast<int>(drop_false(found.first(static_cast<std::size_t>(count)), part_s));
    }
    return count;
  }
  const int count = box_on_plane(second, first, found);
  for (dContactGeom& contact : found.first(static_cast<std::size_t>(count))) {
    for (int k = 0; k < 3; ++k) contact.normal[k] = -contact.normal[k];
    std::swap(contact.g1, contact.g2);
  }
  return count;
}

}  // namespace

std::span<dContactGeom> find_contacts(dxGeom* first, dxGeom* second, std::span<dContactGeom> room, double part_s) {
  const auto found = room.first(static_cast<std::size_t>(find_all(first, second, room, part_s)));
  return found.first(choose_contacts(found));
}

}  // namespace ringdown::scene
