#include "engine/scene/ode_contacts.h"

#include "engine/base/vec3.h"
#include "engine/scene/simulation.h"

#include <ode/ode.h>

#include <algorithm>

namespace ringdown::scene {
namespace {

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// Moves the deepest contact to the front, then each time the one farthest from those already chosen.
std::size_t choose_contacts(std::span<dContactGeom> found) {
  if (found.size() <= kMostContactsPerPair) return found.size();
  std::ranges::iter_swap(found.begin(), std::ranges::max_element(found, {}, &dContactGeom::depth));
  for (std::size_t chosen = 1; chosen < kMostContactsPerPair; ++chosen) {
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
  return kMostContactsPerPair;
}

// Every corner of the box below the plane, with the normal out of the plane. ODE finds at most four, and of a thin
// plate that has sunk in those at one edge, about which it then rocks.
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

int find_all(dxGeom* first, dxGeom* second, std::span<dContactGeom> found) {
  const int one = dGeomGetClass(first), two = dGeomGetClass(second);
  if (one == dBoxClass && two == dPlaneClass) return box_on_plane(first, second, found);
  if (one != dPlaneClass || two != dBoxClass) {
    return dCollide(first, second, kMostContactsFound, found.data(), sizeof(dContactGeom));
  }
  const int count = box_on_plane(second, first, found);
  for (dContactGeom& contact : found.first(static_cast<std::size_t>(count))) {
    for (int k = 0; k < 3; ++k) contact.normal[k] = -contact.normal[k];
    std::swap(contact.g1, contact.g2);
  }
  return count;
}

}  // namespace

std::span<dContactGeom> find_contacts(dxGeom* first, dxGeom* second, std::span<dContactGeom> room) {
  const auto found = room.first(static_cast<std::size_t>(find_all(first, second, room)));
  return found.first(choose_contacts(found));
}

}  // namespace ringdown::scene
