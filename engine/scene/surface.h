// A closed surface of triangles, prepared for finding where two of them touch (surface_contacts.h): its triangles, the
// edges and corners that can touch anything, and a tree of boxes over each kind. Free of any physics engine.
// [any thread]
#pragma once

#include "engine/base/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

struct SurfaceTriangle {
  std::array<Vec3, 3> corners;
  Vec3 normal;                  // unit, outwards
  std::array<Vec3, 3> inwards;  // unit, in the triangle's plane, from the edge that begins at each corner
};

// An edge between two triangles about which the surface is convex.
struct SurfaceEdge {
  Vec3 from, to;
  Vec3 normal, other_normal;  // of its two triangles; unit, outwards
};

// A corner at which such an edge ends. `around` are the unit directions of all its edges.
struct SurfaceCorner {
  Vec3 point;
  std::vector<Vec3> around;
};

// Boxes along the axes around some items, in a tree whose root is the first.
struct BoxNode {
  Vec3 low, high;
  std::uint32_t first = 0, count = 0;  // items of a leaf; count 0: an inner node
  std::uint32_t left = 0, right = 0;   // children of an inner node
};

// Items in the order of the tree's leaves.
template <class Item>
struct BoxTree {
  std::vector<Item> items;
  std::vector<BoxNode> nodes;  // none: no items
};

struct Surface {
  BoxTree<SurfaceTriangle> triangles;
  BoxTree<SurfaceEdge> edges;
  BoxTree<SurfaceCorner> corners;
  double thickness_m = 0;  // twice the volume over the area: of a shell its wall
  double reach_m = 0;      // of the farthest corner from the origin
};

// `triangles` are counter-clockwise from outside. Triangles without area are left out.
Surface make_surface(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
Surface box_surface(Vec3 size);  // about its centre

}  // namespace ringdown::scene
