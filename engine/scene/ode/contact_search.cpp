#include "engine/scene/ode/contact_search.h"

#include "engine/scene/fresh_pairs.h"
#include "engine/scene/ode/collider.h"
#include "engine/scene/ode/surface_pairs.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

// Two limits for meshes: the cosine of the largest angle between normals that agree, and the overlap of meshes at rest.
constexpr double kAgree = 0.7, kRestOverlap_m = 1e-4;

// Contacts whose normals differ by no more than this cosine act in one direction.
constexpr double kAlike = 0.95;

// The least number of corners of a polygon that two hulls share, for it to hold them.
constexpr int kFaceCorners = 4;

// Moves the deepest contact to the front, then repeatedly the contact that differs most in position and direction from
// those already chosen. If directions differ, as in a bowl within a bowl, four points do not hold a body.
FoundContacts choose_contacts(std::span<dContactGeom> found) {
  if (found.size() <= kMaxContactsPerPair) return {found, {}};
  std::ranges::iter_swap(found.begin(), std::ranges::max_element(found, {}, &dContactGeom::depth));
  const Vec3 first = to_vec3(found.front().pos);
  double size_m = 0, agree = 1;
  for (const dContactGeom& contact : found) {
    size_m = std::max(size_m, length(to_vec3(contact.pos) - first));
    agree = std::min(agree, dot(to_vec3(contact.normal), to_vec3(found.front().normal)));
  }
  const std::size_t carry = agree > kAlike ? kMaxContactsPerPair : kMaxContactsOfShells;
  const std::size_t wanted = std::min(found.size(), agree > kAlike ? kMaxContactsPerPair : kMaxContactsMoved);
  std::vector<double> nearest(found.size(), dInfinity);
  for (std::size_t chosen = 1; chosen < wanted; ++chosen) {
    const dContactGeom& taken = found[chosen - 1];
    for (std::size_t k = chosen; k < found.size(); ++k) {
      const Vec3 way = to_vec3(found[k].pos) - to_vec3(taken.pos);
      const Vec3 turn = size_m * (to_vec3(found[k].normal) - to_vec3(taken.normal));
      nearest[k] = std::min(nearest[k], dot(way, way) + dot(turn, turn));
    }
    const auto rest = std::span(nearest).subspan(chosen);
    const auto next = chosen + static_cast<std::size_t>(std::ranges::max_element(rest) - rest.begin());
    std::swap(found[chosen], found[next]);
    std::swap(nearest[chosen], nearest[next]);
  }
  return {found.first(std::min(carry, wanted)), found.first(wanted).subspan(std::min(carry, wanted))};
}

// Makes a contact for every corner of the box below the plane, with the normal out of the plane. ODE itself finds at
// most four; for a thin plate that overlaps the plane these are the corners of one edge, about which the plate then
// rocks.
int box_on_plane(dxGeom* box, dxGeom* plane, std::span<dContactGeom> found) {
  dVector3 size;
  dVector4 half_space;
  dGeomBoxGetLengths(box, size);
  dGeomPlaneGetParams(plane, half_space);
  const Vec3 normal = to_vec3(half_space), middle = to_vec3(dGeomGetPosition(box));
  const dReal* r = dGeomGetRotation(box);
  const auto half_edge = [&](int axis) { return (0.5 * size[axis]) * Vec3{r[axis], r[4 + axis], r[8 + axis]}; };
  const std::array half_edges{half_edge(0), half_edge(1), half_edge(2)};
  int count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 point = middle;
    for (int axis = 0; axis < 3; ++axis) {
      point = corner >> axis & 1 ? point + half_edges[axis] : point - half_edges[axis];
    }
    const double depth = half_space[3] - dot(normal, point);
    if (depth < 0) continue;
    dContactGeom& contact = found[count++];
    contact = {};
    copy(point, contact.pos);
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
  return {collider_of(geom).shape.faces, turn, to_vec3(dGeomGetPosition(geom))};
}

// ODE finds one contact point of two hulls. If faces of the hulls lie on each other, replaces the point by the corners
// of the polygon that the faces share. Returns the number of points.
int spread(std::span<dContactGeom> found) {
  const dContactGeom one = found.front();
  const FaceContact shared = share_of_faces(posed_faces(one.g1), posed_faces(one.g2), to_vec3(one.normal));
  const std::size_t count = std::min(shared.points.size(), found.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [point, depth] = shared.points[k];
    found[k] = one;
    found[k].depth = depth;
    copy(point, found[k].pos);
    copy(shared.normal, found[k].normal);
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
// contact is false if another contact, no farther away than its depth, has less than half of that depth. It is also
// false if its normal disagrees with that of the shallowest contact and it is deeper than the shallowest contact and
// the bodies' approach since the last step can explain.
std::size_t drop_false(std::span<dContactGeom> found, double part_s) {
  if (found.empty()) return 0;
  const dContactGeom min = *std::ranges::min_element(found, {}, &dContactGeom::depth);
  const auto is_false = [&](const dContactGeom& contact) {
    const bool shallower_nearby = std::ranges::any_of(found, [&](const dContactGeom& better) {
      const Vec3 way = to_vec3(better.pos) - to_vec3(contact.pos);
      return better.depth < 0.5 * contact.depth && dot(way, way) <= contact.depth * contact.depth;
    });
    if (shallower_nearby) return true;
    const Vec3 normal = to_vec3(contact.normal);
    if (dot(normal, to_vec3(min.normal)) > kAgree) return false;
    const Vec3 apart = velocity_at(contact.g1, contact.pos) - velocity_at(contact.g2, contact.pos);
    const double came_in_m = 2 * part_s * std::max(-dot(apart, normal), 0.0);
    return contact.depth > 2 * min.depth + kRestOverlap_m + came_in_m;
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

// Returns whether all contacts act in one direction.
bool agree(std::span<const dContactGeom> found) {
  return std::ranges::all_of(found, [&](const dContactGeom& contact) {
    return dot(to_vec3(contact.normal), to_vec3(found.front().normal)) > kAlike;
  });
}

// Returns true if two hulls are farther apart than surfaces that touch may be. ODE tests the planes of all faces and of
// all pairs of edges: 0.1 ms for hulls of 16 corners, most of which do not touch although their boxes overlap. This
// search takes some hundred products a call. If it finds no plane between two hulls that are apart, ODE's own search
// does.
bool far_apart(const Collider& one, const Collider& two) {
  constexpr double kFar_m = 2 * SurfacePairs::kMargin_m;
  constexpr int kMaxCalls = 4;
  const auto hull_of = [](const Collider& collider) {
    const Motion motion = collider.motion();
    return PosedHull{collider.shape.points, to_matrix(motion.rotation), motion.position_m};
  };
  if (one.shape.points.empty() || two.shape.points.empty()) return false;
  const PosedHull of_one = hull_of(one), of_two = hull_of(two);
  const Vec3 way = of_two.position_m - of_one.position_m;
  if (!(length(way) > 0)) return false;
  Vec3 direction = (1 / length(way)) * way;
  for (int call = 0; call < kMaxCalls; ++call) {
    if (are_apart(of_one, of_two, kFar_m, direction)) return true;
  }
  return false;
}

// Finds contacts by the surfaces of two bodies if these serve better than ODE's, otherwise by ODE. Hulls whose faces
// lie on each other rest on the polygon that the faces share, whereas they would rock on corners of round outlines; for
// hulls that share no face ODE finds a single point. Meshes within each other, such as nested bowls, touch in many
// directions, some of which corners and edges miss.
int find_best(dxGeom* first, dxGeom* second, SurfacePairs& pairs, std::span<dContactGeom> room, double part_s) {
  const Collider& one = collider_of(first);
  const Collider& two = collider_of(second);
  if (!SurfacePairs::covers(one, two)) return find_all(first, second, room, part_s);
  if (are_hulls(dGeomGetClass(first), dGeomGetClass(second))) {
    if (far_apart(one, two)) return 0;
    const int on_faces = find_all(first, second, room, part_s);
    if (on_faces >= kFaceCorners) return on_faces;
    const int count = pairs.find(one, two, part_s, room);
    return count > 0 ? count : on_faces;
  }
  const int count = pairs.find(one, two, part_s, room);
  if (count > 0 && agree(room.first(static_cast<std::size_t>(count)))) return count;
  return find_all(first, second, room, part_s);
}

}  // namespace

FoundContacts find_contacts(dxGeom* first, dxGeom* second, SurfacePairs& pairs, std::span<dContactGeom> room,
                            double part_s) {
  return choose_contacts(room.first(static_cast<std::size_t>(find_best(first, second, pairs, room, part_s))));
}

}  // namespace ringdown::scene
