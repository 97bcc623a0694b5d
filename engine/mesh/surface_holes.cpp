#include "engine/mesh/surface_holes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/utility.h>

#include <array>
#include <vector>

namespace ringdown::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

Mesh half_edges_of(const TriangleMesh& soup) {
  std::vector<Point> points;
  for (Eigen::Index n = 0; n < soup.nodes.rows(); ++n) {
    points.emplace_back(soup.nodes(n, 0), soup.nodes(n, 1), soup.nodes(n, 2));
  }
  std::vector<std::array<std::size_t, 3>> triangles;
  for (Eigen::Index t = 0; t < soup.triangles.rows(); ++t) {
    const auto row = soup.triangles.row(t);
    triangles.push_back(
        {static_cast<std::size_t>(row[0]), static_cast<std::size_t>(row[1]), static_cast<std::size_t>(row[2])});
  }
  pmp::orient_polygon_soup(points, triangles);
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  return mesh;
}

TriangleMesh soup_of(Mesh& mesh) {
  mesh.collect_garbage();
  TriangleMesh soup;
  soup.nodes.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
  soup.triangles.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
  for (const auto v : mesh.vertices()) {
    const Point& at = mesh.point(v);
    soup.nodes.row(static_cast<Eigen::Index>(v.idx())) << at.x(), at.y(), at.z();
  }
  Eigen::Index row = 0;
  for (const auto f : mesh.faces()) {
    int i = 0;
    for (const auto v : vertices_around_face(mesh.halfedge(f), mesh)) {
      soup.triangles(row, i++) = static_cast<std::int32_t>(v.idx());
    }
    ++row;
  }
  return soup;
}

}  // namespace

TriangleMesh part(const TriangleMesh& soup) {
  Mesh mesh = half_edges_of(soup);
  pmp::stitch_borders(mesh);
  return soup_of(mesh);
}

Triangles span(const std::vector<Eigen::RowVector3d>& way) {
  std::vector<Point> points;
  for (const Eigen::RowVector3d& at : way) points.emplace_back(at[0], at[1], at[2]);
  std::vector<CGAL::Triple<int, int, int>> found;
  pmp::triangulate_hole_polyline(points, std::back_inserter(found));
  Triangles triangles(static_cast<Eigen::Index>(found.size()), 3);
  Eigen::Index row = 0;
  for (const auto& triple : found) triangles.row(row++) << triple.first, triple.second, triple.third;
  return triangles;
}

}  // namespace ringdown::mesh
