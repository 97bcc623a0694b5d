#include "engine/mesh/surface_holes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace ringdown::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Halfedge = Mesh::Halfedge_index;

Mesh half_edges_of(const TriangleMesh& soup, int& parted) {
  std::vector<Point> points;
  for (Eigen::Index n = 0; n < soup.nodes.rows(); ++n) {
    points.emplace_back(soup.nodes(n, 0), soup.nodes(n, 1), soup.nodes(n, 2));
  }
  std::vector<std::array<std::size_t, 3>> triangles;
  for (Eigen::Index t = 0; t < soup.triangles.rows(); ++t) {
    const auto row = soup.triangles.row(t);
    triangles.push_back({static_cast<std::size_t>(row[0]), static_cast<std::size_t>(row[1]), static_cast<std::size_t>(row[2])});
  }
  const std::size_t before = points.size();
  pmp::orient_polygon_soup(points, triangles);
  parted = static_cast<int>(points.size() - before);
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

struct Loop {
  double perimeter_m = 0;
  bool flat = true;
};

Loop measure(const Mesh& mesh, Halfedge border) {
  constexpr double kFlat = 1e-3;  // of the perimeter
  std::vector<Eigen::Vector3d> corners;
  for (const Halfedge h : halfedges_around_face(border, mesh)) {
    const Point& at = mesh.point(mesh.target(h));
    corners.emplace_back(at.x(), at.y(), at.z());
  }
  Loop loop;
  Eigen::Vector3d area = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : corners) middle += corner / static_cast<double>(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d &from = corners[i], &to = corners[(i + 1) % corners.size()];
    loop.perimeter_m += (to - from).norm();
    area += (from - middle).cross(to - middle);
  }
  for (const Eigen::Vector3d& corner : corners) {
    if (std::abs((corner - middle).dot(area.normalized())) > kFlat * loop.perimeter_m) loop.flat = false;
  }
  return loop;
}

void close_holes(Mesh& mesh, double longest_hole_m, Sewn& done) {
  std::vector<Halfedge> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  done.left_open = 0;
  for (const Halfedge border : borders) {
    const Loop loop = measure(mesh, border);
    std::vector<Mesh::Face_index> patch;
    if (loop.flat || loop.perimeter_m <= longest_hole_m) {
      pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
    }
    patch.empty() ? ++done.left_open : ++done.closed;
  }
}

}  // namespace

Sewn sew(const TriangleMesh& soup, double longest_hole_m) {
  Sewn done;
  Mesh mesh = half_edges_of(soup, done.parted);
  done.sewn = static_cast<int>(pmp::stitch_borders(mesh));
  close_holes(mesh, longest_hole_m, done);
  const auto before = mesh.number_of_faces();
  pmp::remove_degenerate_faces(mesh);
  done.flattened = static_cast<int>(before) - static_cast<int>(mesh.number_of_faces());
  done.mesh = soup_of(mesh);
  return done;
}

}  // namespace ringdown::mesh
