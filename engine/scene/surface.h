// A closed surface of triangles, prepared for finding contacts with another one (surface_contacts.h): its triangles,
// the edges and corners that can touch anything, and a tree of boxes over each kind. Free of any physics engine. [any
// thread]
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
  std::array<Vec3, 3> inwards;  // unit, in the triangle's plane, pointing inwards from the edge that begins at each
                                // corner
};

// An edge at which the surface is convex.
struct SurfaceEdge {
  Vec3 from, to;
  Vec3 normal, other_normal;  // normals of its two triangles; unit, outwards
};

// A corner at which a convex edge ends. `around` holds the unit directions of all edges at the corner.
struct SurfaceCorner {
  Vec3 point;
  std::vector<Vec3> around;
};

// A node of a tree of axis-aligned boxes around items. The first node is the root.
struct BoxNode {
  Vec3 low, high;
  std::uint32_t first = 0, count = 0;  // items of a leaf; count 0: an inner node
  std::uint32_t left = 0, right = 0;   // children of an inner node
};

// Items in the order of the tree's leaves.
template <class Item>
struct BoxTree {
  std::vector<Item> items;
  std::vector<BoxNode> nodes;  // empty if there are no items
};

struct Surface {
  BoxTree<SurfaceTriangle> triangles;
  BoxTree<SurfaceEdge> edges;
  BoxTree<SurfaceCorner> corners;
  double thickness_m = 0;  // twice the volume over the area; the wall thickness of a shell
  double reach_m = 0;      // distance of the farthest corner from the origin
};

// Triangles must be counter-clockwise from outside. Those without area are left out.
Surface make_surface(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
Surface box_surface(Vec3 size);  // centred at the origin

}  // namespace ringdown::scene
