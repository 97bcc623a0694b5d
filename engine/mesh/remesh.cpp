#include "engine/mesh/remesh.h"

#include "engine/mesh/surface_distance.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/utility.h>

#include <algorithm>
#include <array>
#include <vector>

namespace ringdown::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

// Points and triangles as CGAL takes them.
struct PolygonSoup {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;

  explicit PolygonSoup(const TriangleMesh& surface) {
    for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
      points.emplace_back(surface.nodes(n, 0), surface.nodes(n, 1), surface.nodes(n, 2));
    }
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      const auto row = surface.triangles.row(t);
      triangles.push_back(
          {static_cast<std::size_t>(row[0]), static_cast<std::size_t>(row[1]), static_cast<std::size_t>(row[2])});
    }
  }

  // The triangles must hang together as a surface does.
  [[nodiscard]] Mesh half_edges() const {
    Mesh mesh;
    pmp::polygon_soup_to_polygon_mesh(points, triangles, mesh);
    return mesh;
  }
};

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

// The largest distance from the middles of the triangles and of their edges to the surface `from`: a one-sided
// Hausdorff distance, sampled. The corners are left out, because remeshing projects them onto the surface.
double deviation(const TriangleMesh& mesh, const SurfaceRays& from) {
  double most = 0;
  const auto measure = [&](const Eigen::RowVector3d& at) { most = std::max(most, (from.nearest(at) - at).norm()); };
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const auto row = mesh.triangles.row(t);
    const Eigen::RowVector3d a = mesh.nodes.row(row[0]), b = mesh.nodes.row(row[1]), c = mesh.nodes.row(row[2]);
    measure((a + b + c) / 3);
    if (row[0] < row[1]) measure((a + b) / 2);
    if (row[1] < row[2]) measure((b + c) / 2);
    if (row[2] < row[0]) measure((c + a) / 2);
  }
  return most;
}

}  // namespace

TriangleMesh separate(const TriangleMesh& soup) {
  PolygonSoup apart(soup);
  pmp::orient_polygon_soup(apart.points, apart.triangles);
  Mesh mesh = apart.half_edges();
  pmp::stitch_borders(mesh);
  return soup_of(mesh);
}

Triangles triangulate(const std::vector<Eigen::RowVector3d>& loop) {
  std::vector<Point> points;
  for (const Eigen::RowVector3d& at : loop) points.emplace_back(at[0], at[1], at[2]);
  std::vector<CGAL::Triple<int, int, int>> found;
  const bool large = points.size() > kMaxExactHole;
  pmp::triangulate_hole_polyline(points, std::back_inserter(found),
                                 CGAL::parameters::use_delaunay_triangulation(true).do_not_use_cubic_algorithm(large));
  Triangles triangles(static_cast<Eigen::Index>(found.size()), 3);
  Eigen::Index row = 0;
  for (const auto& triple : found) triangles.row(row++) << triple.first, triple.second, triple.third;
  return triangles;
}

// Isotropic remeshing: edges longer than 4/3 of the wanted length are split, those shorter than 4/5 are collapsed,
// edges are flipped so that nodes have six neighbours, and nodes are moved towards the middle of their neighbours and
// back onto the surface; kRounds times. Source: Botsch & Kobbelt, A Remeshing Approach to Multiresolution Modeling, SGP
// 2004, which is what CGAL implements. Edges sharper than kSharpAngle_deg are constrained: they are neither flipped nor
// smoothed away.
Result<Remeshed> remesh(const TriangleMesh& surface, double edge_m) {
  constexpr unsigned kRounds = 4;
  try {
    const PolygonSoup soup(surface);
    if (!pmp::is_polygon_soup_a_polygon_mesh(soup.triangles)) {
      return fail(ErrorKind::bad_input, "the surface runs together at an edge or a point");
    }
    Mesh mesh = soup.half_edges();
    auto sharp = mesh.add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
    pmp::detect_sharp_edges(mesh, kSharpAngle_deg, sharp);
    pmp::isotropic_remeshing(mesh.faces(), edge_m, mesh,
                             CGAL::parameters::number_of_iterations(kRounds).edge_is_constrained_map(sharp));
    Remeshed remeshed{.mesh = soup_of(mesh)};
    if (remeshed.mesh.triangles.rows() < 4) return fail(ErrorKind::bad_input, "nothing is left of it at that size");
    remeshed.deviation_m = deviation(remeshed.mesh, SurfaceRays(surface));
    return remeshed;
  } catch (const std::exception& exception) {
    return fail(ErrorKind::bad_input, std::string("CGAL cannot remesh it: ") + exception.what());
  }
}

}  // namespace ringdown::mesh
