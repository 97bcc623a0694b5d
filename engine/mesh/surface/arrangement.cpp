#include "engine/mesh/surface/arrangement.h"

#include "engine/base/groups.h"
#include "engine/mesh/surface/surface_check.h"

// Silences CGAL's warning at every start about exact crossings of crossings, which are few here.
#define CGAL_NO_CDT_2_WARNING
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Object.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <utility>

// Cutting a surface along itself
//
// 1. Pairs of triangles that meet are found by exact predicates (self_intersections()).
// 2. Each pair meets in a point, in a segment, or, where both lie in one plane, in a polygon. The point or the segment
//    is noted with both triangles; those that share a polygon are put into one group.
// 3. Each group is a set of triangles in one plane. Its sides and the segments noted for it are the constraints of a
//    Delaunay triangulation of that plane, whose triangles are the parts. A part belongs to every triangle of the group
//    that its middle lies in.
// 4. New points have exact coordinates, so the point in which three triangles meet is the same point, and one node,
//    whichever of the three it is computed in.
// Source: Q. Zhou, E. Grinspun, D. Zorin & A. Jacobson, Mesh Arrangements for Solid Geometry, ACM Trans. Graph. 35(4),
// 2016, section 4.
namespace ringdown::mesh {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Exact::Point_3;
using FlatPoint = Exact::Point_2;

struct NodeNumber {
  std::int32_t number = -1;
};
using FlatVertex = CGAL::Triangulation_vertex_base_with_info_2<NodeNumber, Exact>;
using FlatFace = CGAL::Constrained_triangulation_face_base_2<Exact>;
using FlatStructure = CGAL::Triangulation_data_structure_2<FlatVertex, FlatFace>;
using FlatTriangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Exact, FlatStructure, CGAL::Exact_intersections_tag>;

// Triangles in one plane, and the segments that other triangles cut into them.
struct Group {
  std::vector<std::int32_t> triangles;
  std::vector<std::array<std::int32_t, 2>> segments;  // pairs of nodes; a point is one node twice
};

class Arranger {
 public:
  explicit Arranger(const TriangleMesh& mesh) : mesh_(mesh), groups_(static_cast<std::size_t>(mesh.triangles.rows())) {}

  Result<Arrangement> run() {
    const auto pairs = self_intersections(mesh_, kMaxCuts);
    if (pairs.size() >= kMaxCuts) return fail(ErrorKind::too_large, "its triangles cut each other too often");
    for (const auto& [a, b] : pairs) {
      for (const std::int32_t t : {a, b}) {
        for (int i = 0; i < 3; ++i) know(mesh_.triangles(t, i));
      }
    }
    std::vector<std::pair<std::int32_t, std::array<std::int32_t, 2>>> segments;  // triangle and nodes
    for (const auto& [a, b] : pairs) {
      met_.clear();
      if (meet(a, b)) groups_.join_to(a, b);
      for (const auto& segment : met_) {
        segments.emplace_back(a, segment);
        segments.emplace_back(b, segment);
      }
    }
    std::map<std::int32_t, Group> groups;
    std::vector<bool> cut(static_cast<std::size_t>(mesh_.triangles.rows()), false);
    for (const auto& pair : pairs) {
      for (const std::int32_t t : pair) {
        if (cut[static_cast<std::size_t>(t)]) continue;
        cut[static_cast<std::size_t>(t)] = true;
        groups[groups_.root(t)].triangles.push_back(t);
      }
    }
    for (const auto& [triangle, segment] : segments) groups[groups_.root(triangle)].segments.push_back(segment);
    for (const auto& [first, group] : groups) triangulate(group);
    for (std::size_t t = 0; t < cut.size(); ++t) {
      if (cut[t]) continue;
      const auto row = mesh_.triangles.row(static_cast<Eigen::Index>(t));
      add({row[0], row[1], row[2]}, 1);
    }
    return finished();
  }

 private:
  [[nodiscard]] ExactPoint exact(std::int32_t node) const {
    const auto new_one = node - mesh_.nodes.rows();
    if (new_one >= 0) return made_[static_cast<std::size_t>(new_one)];
    return {mesh_.nodes(node, 0), mesh_.nodes(node, 1), mesh_.nodes(node, 2)};
  }
  [[nodiscard]] ExactPoint corner(std::int32_t triangle, int i) const { return exact(mesh_.triangles(triangle, i)); }
  [[nodiscard]] Exact::Triangle_3 exact_triangle(std::int32_t t) const {
    return {corner(t, 0), corner(t, 1), corner(t, 2)};
  }

  void know(std::int32_t node) { number_.emplace(exact(node), node); }

  std::int32_t number(const ExactPoint& at) {
    const auto [known, fresh] =
        number_.emplace(at, static_cast<std::int32_t>(mesh_.nodes.rows() + static_cast<Eigen::Index>(made_.size())));
    if (fresh) made_.push_back(at);
    return known->second;
  }

  // Records in met_ the segment or point that two triangles have in common. Returns true if they share a polygon.
  bool meet(std::int32_t a, std::int32_t b) {
    const auto met = CGAL::intersection(exact_triangle(a), exact_triangle(b));
    if (!met) return false;
    const CGAL::Object what(*met);
    if (const auto* segment = CGAL::object_cast<Exact::Segment_3>(&what)) {
      met_.push_back({number(segment->source()), number(segment->target())});
    } else if (const auto* point = CGAL::object_cast<ExactPoint>(&what)) {
      const std::int32_t only = number(*point);
      met_.push_back({only, only});
    } else {
      return true;
    }
    return false;
  }

  // The plane of a group, projected along the axis nearest to its normal.
  struct Plane {
    Exact::Plane_3 plane;
    int u = 0, v = 1, w = 2;  // axes; w is left out

    [[nodiscard]] FlatPoint flat(const ExactPoint& at) const { return {at[u], at[v]}; }
    [[nodiscard]] ExactPoint lifted(const FlatPoint& at) const {
      const std::array<Exact::FT, 3> normal = {plane.a(), plane.b(), plane.c()};
      std::array<Exact::FT, 3> x;
      x[static_cast<std::size_t>(u)] = at.x();
      x[static_cast<std::size_t>(v)] = at.y();
      x[static_cast<std::size_t>(w)] =
          -(normal[static_cast<std::size_t>(u)] * at.x() + normal[static_cast<std::size_t>(v)] * at.y() + plane.d()) /
          normal[static_cast<std::size_t>(w)];
      return {x[0], x[1], x[2]};
    }
  };

  [[nodiscard]] Plane plane_of(std::int32_t triangle) const {
    const auto row = mesh_.triangles.row(triangle);
    const Eigen::RowVector3d a = mesh_.nodes.row(row[0]), b = mesh_.nodes.row(row[1]), c = mesh_.nodes.row(row[2]);
    Plane plane{Exact::Plane_3(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2))};
    (b - a).cross(c - a).cwiseAbs().maxCoeff(&plane.w);
    plane.u = (plane.w + 1) % 3;
    plane.v = (plane.w + 2) % 3;
    return plane;
  }

  struct FlatTriangle {
    std::array<FlatPoint, 3> corners;  // counter-clockwise
    int facing = 1;                    // -1: the triangle runs clockwise
  };

  void triangulate(const Group& group) {
    const Plane plane = plane_of(group.triangles.front());
    FlatTriangulation flat;
    const auto vertex = [&](std::int32_t node) {
      const auto made = flat.insert(plane.flat(exact(node)));
      made->info().number = node;
      return made;
    };
    std::vector<FlatTriangle> triangles;
    for (const std::int32_t t : group.triangles) {
      FlatTriangle& triangle = triangles.emplace_back();
      for (int i = 0; i < 3; ++i) {
        triangle.corners[static_cast<std::size_t>(i)] = plane.flat(corner(t, i));
        flat.insert_constraint(vertex(mesh_.triangles(t, i)), vertex(mesh_.triangles(t, (i + 1) % 3)));
      }
      auto& [a, b, c] = triangle.corners;
      if (CGAL::orientation(a, b, c) == CGAL::CLOCKWISE) {
        std::swap(b, c);
        triangle.facing = -1;
      }
    }
    for (const auto& [a, b] : group.segments) {
      const auto from = vertex(a), to = vertex(b);
      if (from != to) flat.insert_constraint(from, to);
    }
    for (auto v = flat.finite_vertices_begin(); v != flat.finite_vertices_end(); ++v) {
      if (v->info().number < 0) v->info().number = number(plane.lifted(v->point()));
    }
    for (auto face = flat.finite_faces_begin(); face != flat.finite_faces_end(); ++face) {
      std::array<std::int32_t, 3> part;
      std::array<FlatPoint, 3> points;
      for (int i = 0; i < 3; ++i) {
        part[static_cast<std::size_t>(i)] = face->vertex(i)->info().number;
        points[static_cast<std::size_t>(i)] = face->vertex(i)->point();
      }
      const int layers = triangles.size() == 1 ? triangles.front().facing
                                               : layers_at(CGAL::centroid(points[0], points[1], points[2]), triangles);
      if (layers < 0) std::swap(part[1], part[2]);
      if (layers != 0) add(part, std::abs(layers));
    }
  }

  static int layers_at(const FlatPoint& at, const std::vector<FlatTriangle>& triangles) {
    int layers = 0;
    for (const auto& [corners, facing] : triangles) {
      const auto& [a, b, c] = corners;
      const bool inside = CGAL::orientation(a, b, at) == CGAL::COUNTERCLOCKWISE &&
                          CGAL::orientation(b, c, at) == CGAL::COUNTERCLOCKWISE &&
                          CGAL::orientation(c, a, at) == CGAL::COUNTERCLOCKWISE;
      layers += inside ? facing : 0;
    }
    return layers;
  }

  void add(const std::array<std::int32_t, 3>& triangle, int layers) {
    parts_.push_back(triangle);
    layers_.push_back(layers);
  }

  Arrangement finished() {
    Arrangement arrangement{.mesh = {}, .layers = std::move(layers_)};
    const Eigen::Index known = mesh_.nodes.rows();
    arrangement.mesh.nodes.resize(known + static_cast<Eigen::Index>(made_.size()), 3);
    arrangement.mesh.nodes.topRows(known) = mesh_.nodes;
    Eigen::Index node = known;
    for (const ExactPoint& at : made_) {
      for (int axis = 0; axis < 3; ++axis) arrangement.mesh.nodes(node, axis) = CGAL::to_double(CGAL::exact(at[axis]));
      ++node;
    }
    arrangement.mesh.triangles.resize(static_cast<Eigen::Index>(parts_.size()), 3);
    for (std::size_t t = 0; t < parts_.size(); ++t) {
      arrangement.mesh.triangles.row(static_cast<Eigen::Index>(t)) << parts_[t][0], parts_[t][1], parts_[t][2];
    }
    return arrangement;
  }

  const TriangleMesh& mesh_;
  Groups<std::int32_t> groups_;  // of triangles
  std::map<ExactPoint, std::int32_t> number_;
  std::vector<ExactPoint> made_;
  std::vector<std::array<std::int32_t, 2>> met_;
  std::vector<std::array<std::int32_t, 3>> parts_;
  std::vector<int> layers_;
};

}  // namespace

Result<Arrangement> arrange(const TriangleMesh& mesh) {
  try {
    return Arranger(mesh).run();
  } catch (const std::exception& exception) {
    return fail(ErrorKind::bad_input, std::string("CGAL cannot cut it: ") + exception.what());
  }
}

}  // namespace ringdown::mesh
