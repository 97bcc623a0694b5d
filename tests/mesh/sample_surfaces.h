// Surfaces made by the tests, and ways to damage them. Shapes as CAD programs triangulate them: no more triangles than
// it takes to follow them. All are sound and turned outward.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace ringdown::test {

using Vec = Eigen::RowVector3d;

mesh::TriangleMesh box(const Vec& low, const Vec& high);  // 12 triangles

// A closed polygon (r, z) turned about the z axis; the inside is to the left of its way. Corners with r = 0 become one
// point each.
mesh::TriangleMesh lathe(const std::vector<std::array<double, 2>>& profile, int segments);
mesh::TriangleMesh cylinder(double radius, double height, int segments);
mesh::TriangleMesh tube(double inner, double outer, double height, int segments);
mesh::TriangleMesh cup(double radius, double height, double wall, int segments);
mesh::TriangleMesh bowl(double radius, double wall, int segments);  // half of a hollow sphere
mesh::TriangleMesh sphere(double radius, int segments);
mesh::TriangleMesh torus(double radius, double section, int segments);

// A polygon in the plane z = 0, counter-clockwise, as a prism; `fans` are its triangles.
mesh::TriangleMesh l_shape(double length, double width, double height);

mesh::TriangleMesh united(const mesh::TriangleMesh& a,
                          const mesh::TriangleMesh& b);  // beside each other, nothing joined
mesh::TriangleMesh inside_out(mesh::TriangleMesh mesh);
mesh::TriangleMesh moved(mesh::TriangleMesh mesh, const Vec& by);
mesh::TriangleMesh subdivided(const mesh::TriangleMesh& mesh);  // each triangle in four

// Damages.
mesh::TriangleMesh without(const mesh::TriangleMesh& mesh, const std::vector<int>& triangles);
mesh::TriangleMesh with_flipped(mesh::TriangleMesh mesh, int every);
mesh::TriangleMesh with_copies(const mesh::TriangleMesh& mesh, int every);
mesh::TriangleMesh with_fin(const mesh::TriangleMesh& mesh, const Vec& tip);       // on the first edge
mesh::TriangleMesh with_split_side(const mesh::TriangleMesh& mesh, int triangle);  // a triangle without area beside it
mesh::TriangleMesh exploded(const mesh::TriangleMesh& mesh, double jitter);        // three points to each triangle
mesh::TriangleMesh with_stray_points(const mesh::TriangleMesh& mesh, int count);

}  // namespace ringdown::test
