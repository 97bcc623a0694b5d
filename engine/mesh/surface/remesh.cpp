#include "engine/mesh/surface/remesh.h"

#include "engine/mesh/surface/surface_distance.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/utility.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace ringdown::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

// Points and triangles in the form that CGAL takes.
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

  // The triangles must be connected as in a manifold surface.
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

// Returns for each triangle the largest distance of its middle and of its sides' middles from the surface `from`. The
// corners are left out, because they lie on that surface.
std::vector<double> deviations(const TriangleMesh& mesh, const SurfaceRays& from) {
  std::vector<double> max;
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const auto row = mesh.triangles.row(t);
    const Eigen::RowVector3d a = mesh.nodes.row(row[0]), b = mesh.nodes.row(row[1]), c = mesh.nodes.row(row[2]);
    double farthest = 0;
    for (const Eigen::RowVector3d& at : {Eigen::RowVector3d((a + b + c) / 3), Eigen::RowVector3d((a + b) / 2),
                                         Eigen::RowVector3d((b + c) / 2), Eigen::RowVector3d((c + a) / 2)}) {
      farthest = std::max(farthest, (from.nearest(at) - at).norm());
    }
    max.push_back(farthest);
  }
  return max;
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

// Graded remeshing
//
// Isotropic remeshing (Botsch & Kobbelt, A Remeshing Approach to Multiresolution Modeling, SGP 2004, which is what CGAL
// implements) splits edges longer than 4/3 of the wanted length, collapses those shorter than 4/5, flips edges so that
// nodes have six neighbours, and moves nodes towards the middle of their neighbours and back onto the surface. Edges
// sharper than kSharpAngle_deg are constrained: they are neither flipped nor smoothed away.
//
// The first level has the shortest edges everywhere. Then, level by level, the triangles that may be larger are
// remeshed with edges kGrowth times as long. A triangle may be larger if the surface turns little enough around its
// corners, if it has no smaller neighbour, and if the larger triangle leaves the surface by no more than the body's
// thickness there allows. The turn is measured on the triangles of the level, between normals that are averaged around
// each node, so bumps smaller than these triangles, such as a scanner's noise, do not keep triangles small. Sharp edges
// may turn half as much as faces. Last, the nodes are put onto the old surface.
namespace {

constexpr double kGrowth = 1.6;
constexpr double kTurnOfCrease = 0.5;  // nodes of higher order follow faces better than the edges between them
constexpr unsigned kRoundsOfFirst = 4, kRoundsOfLevel = 2;

class GradedRemeshing {
 public:
  explicit GradedRemeshing(Mesh& mesh) : mesh_(mesh) {
    sharp_ = mesh_.add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
    done_ = mesh_.add_property_map<Mesh::Face_index, bool>("f:done", false).first;
    pmp::detect_sharp_edges(mesh_, kSharpAngle_deg, sharp_);
  }

  void run(const EdgeLengths& lengths) {
    double level_m = std::min(lengths.longest_m, lengths.shortest_m);
    std::vector<Mesh::Face_index> faces(mesh_.faces().begin(), mesh_.faces().end());
    remesh(faces, level_m, kRoundsOfFirst);
    while (level_m < 0.99 * lengths.longest_m && !faces.empty()) {
      const double growth = std::min(kGrowth, lengths.longest_m / level_m);
      faces = faces_to_grow(lengths, level_m, growth);
      level_m *= growth;
      if (!faces.empty()) remesh(faces, level_m, kRoundsOfLevel);
    }
  }

  [[nodiscard]] bool on_sharp_edge(Mesh::Vertex_index v) const {
    for (const auto h : halfedges_around_target(mesh_.halfedge(v), mesh_)) {
      if (sharp_[mesh_.edge(h)]) return true;
    }
    return false;
  }

 private:
  void remesh(const std::vector<Mesh::Face_index>& faces, double edge_m, unsigned rounds) {
    pmp::isotropic_remeshing(faces, edge_m, mesh_,
                             CGAL::parameters::number_of_iterations(rounds).edge_is_constrained_map(sharp_));
  }

  // The angle by which the surface turns along an edge that is not sharp.
  [[nodiscard]] double turn_along(Mesh::Edge_index edge, const std::vector<Eigen::Vector3d>& face_normals,
                                  const std::vector<Eigen::Vector3d>& node_normals) const {
    const auto h = mesh_.halfedge(edge);
    const auto a = mesh_.source(h), b = mesh_.target(h);
    const bool smooth = !on_sharp_edge(a) && !on_sharp_edge(b);
    const Eigen::Vector3d& from = smooth ? node_normals[a] : face_normals[mesh_.face(h)];
    const Eigen::Vector3d& to = smooth ? node_normals[b] : face_normals[mesh_.face(mesh_.opposite(h))];
    return std::atan2(from.cross(to).norm(), from.dot(to));
  }

  // The angle by which a sharp edge turns at a node in which two sharp edges meet.
  [[nodiscard]] double turn_of_crease(Mesh::Vertex_index v) const {
    std::vector<Eigen::Vector3d> ways;
    for (const auto h : halfedges_around_target(mesh_.halfedge(v), mesh_)) {
      if (!sharp_[mesh_.edge(h)]) continue;
      const auto way = mesh_.point(v) - mesh_.point(mesh_.source(h));
      ways.emplace_back(way.x(), way.y(), way.z());
    }
    if (ways.size() != 2) return 0;
    return std::atan2(ways[0].cross(ways[1]).norm(), -ways[0].dot(ways[1]));
  }

  // Returns for each face the distance by which triangles may leave the surface there.
  [[nodiscard]] std::vector<double> ways_to_leave(const EdgeLengths& lengths) {
    const SurfaceRays rays(soup_of(mesh_));
    std::vector<double> ways(mesh_.number_of_faces(), std::numeric_limits<double>::max());
    if (!(lengths.leave_m > 0)) return ways;
    for (const auto f : mesh_.faces()) {
      if (done_[f]) continue;
      ways[f] = std::max(lengths.leave_m, lengths.leave_share * rays.inward(static_cast<Eigen::Index>(f.idx())));
    }
    return ways;
  }

  // Returns the faces whose edges may become `growth` times as long. If a surface turns by an angle along edges of
  // length e, the middle of the triangle leaves the surface by e / 6 times that angle.
  std::vector<Mesh::Face_index> faces_to_grow(const EdgeLengths& lengths, double level_m, double growth) {
    const std::vector<double> ways = ways_to_leave(lengths);
    const double max_turn = lengths.turn_deg / growth * std::numbers::pi / 180;
    std::vector<Eigen::Vector3d> face_normals(mesh_.number_of_faces() + mesh_.number_of_removed_faces());
    std::vector<Eigen::Vector3d> node_normals(mesh_.number_of_vertices() + mesh_.number_of_removed_vertices(),
                                              Eigen::Vector3d::Zero());
    for (const auto f : mesh_.faces()) {
      const auto h = mesh_.halfedge(f);
      const Point &a = mesh_.point(mesh_.source(h)), &b = mesh_.point(mesh_.target(h)),
                  &c = mesh_.point(mesh_.target(mesh_.next(h)));
      const auto product = CGAL::cross_product(b - a, c - a);
      const Eigen::Vector3d normal(product.x(), product.y(), product.z());
      face_normals[f] = normal.normalized();
      for (const auto v : vertices_around_face(h, mesh_)) node_normals[v] += normal;
    }
    for (Eigen::Vector3d& normal : node_normals) normal.normalize();
    std::vector<bool> bent(node_normals.size(), false), beside_done(node_normals.size(), false);
    for (const auto e : mesh_.edges()) {
      if (sharp_[e]) continue;
      const double turn = turn_along(e, face_normals, node_normals);
      const auto h = mesh_.halfedge(e);
      const double leave_m = std::min(ways[mesh_.face(h)], ways[mesh_.face(mesh_.opposite(h))]);
      if (turn <= max_turn && turn * level_m * growth * growth / 6 <= leave_m) continue;
      bent[mesh_.source(mesh_.halfedge(e))] = bent[mesh_.target(mesh_.halfedge(e))] = true;
    }
    for (const auto v : mesh_.vertices()) {
      if (turn_of_crease(v) > kTurnOfCrease * max_turn) bent[v] = true;
    }
    for (const auto f : mesh_.faces()) {
      if (!done_[f]) continue;
      for (const auto v : vertices_around_face(mesh_.halfedge(f), mesh_)) beside_done[v] = true;
    }
    std::vector<Mesh::Face_index> faces;
    for (const auto f : mesh_.faces()) {
      bool grows = !done_[f];
      for (const auto v : vertices_around_face(mesh_.halfedge(f), mesh_)) grows = grows && !bent[v] && !beside_done[v];
      if (grows) faces.push_back(f);
    }
    for (const auto f : mesh_.faces()) done_[f] = true;
    for (const auto f : faces) done_[f] = false;
    return faces;
  }

  Mesh& mesh_;
  Mesh::Property_map<Mesh::Edge_index, bool> sharp_;
  Mesh::Property_map<Mesh::Face_index, bool> done_;
};

}  // namespace

Result<Remeshed> remesh(const TriangleMesh& surface, const EdgeLengths& lengths) {
  try {
    const PolygonSoup soup(surface);
    if (!pmp::is_polygon_soup_a_polygon_mesh(soup.triangles)) {
      return fail(ErrorKind::bad_input, "the surface runs together at an edge or a point");
    }
    Mesh mesh = soup.half_edges();
    GradedRemeshing grading(mesh);
    grading.run(lengths);
    const SurfaceRays old(surface);
    for (const auto v : mesh.vertices()) {
      if (grading.on_sharp_edge(v)) continue;
      const Point& at = mesh.point(v);
      const Eigen::RowVector3d on = old.nearest({at.x(), at.y(), at.z()});
      mesh.point(v) = Point(on[0], on[1], on[2]);
    }
    Remeshed remeshed{.mesh = soup_of(mesh), .deviations_m = {}};
    if (remeshed.mesh.triangles.rows() < 4) return fail(ErrorKind::bad_input, "no triangle is left at this size");
    remeshed.deviations_m = deviations(remeshed.mesh, old);
    return remeshed;
  } catch (const std::exception& exception) {
    return fail(ErrorKind::bad_input, std::string("CGAL cannot remesh it: ") + exception.what());
  }
}

}  // namespace ringdown::mesh
