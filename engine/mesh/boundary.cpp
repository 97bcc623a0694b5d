#include "engine/mesh/boundary.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

// All faces of all elements are sorted by their corners; a face that occurs once belongs to the boundary. The nodes of
// such a face, including those between its corners, become flat triangles (parts_of_face()).
namespace ringdown::mesh {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Returns the face with its lowest number first, without changing its orientation.
Triangle lowest_first(Triangle face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

Triangle sorted(Triangle face) {
  std::sort(face.begin(), face.end());
  return face;
}

// Returns the p^2 triangles between an element's nodes on one of its faces, oriented like kTetFaces.
std::vector<Triangle> parts_of_face(int order, int face) {
  const auto node_at = [&](int i, int j, int k) {  // shares of the face's corners, p in all
    Barycentric place = Barycentric::Zero(1, 4);
    place(kTetFaces[face][0]) = i;
    place(kTetFaces[face][1]) = j;
    place(kTetFaces[face][2]) = k;
    return nodes_at(order, place / order)[0];
  };
  std::vector<Triangle> parts;
  for (int i = 0; i < order; ++i) {
    for (int j = 0; i + j < order; ++j) {
      const int k = order - 1 - i - j;
      parts.push_back({node_at(i + 1, j, k), node_at(i, j + 1, k), node_at(i, j, k + 1)});
      if (k > 0) parts.push_back({node_at(i + 1, j + 1, k - 1), node_at(i, j + 1, k), node_at(i + 1, j, k)});
    }
  }
  return parts;
}

Boundary number_points(const std::vector<Triangle>& faces) {
  Boundary surface;
  for (const Triangle& face : faces) surface.nodes.insert(surface.nodes.end(), face.begin(), face.end());
  std::sort(surface.nodes.begin(), surface.nodes.end());
  surface.nodes.erase(std::unique(surface.nodes.begin(), surface.nodes.end()), surface.nodes.end());
  const auto position = [&](std::int32_t node) {
    return static_cast<std::uint32_t>(std::lower_bound(surface.nodes.begin(), surface.nodes.end(), node) -
                                      surface.nodes.begin());
  };
  for (const Triangle& face : faces) {
    surface.triangles.push_back({position(face[0]), position(face[1]), position(face[2])});
  }
  return surface;
}

// A point on a face, in the element's own coordinates.
struct PointOnFace {
  std::vector<int> nodes;                          // the element's nodes that lie on the face
  Eigen::VectorXd values;                          // values of the element's shape functions
  Eigen::Matrix<double, Eigen::Dynamic, 2> sides;  // derivatives of all shape functions along two sides of the face
  double weight = 0;                               // the weights of all points on the face sum to 1
};

// A point of the reference element, and the share of its face that it represents.
struct FacePlace {
  Eigen::Vector4d at;
  double weight;
};

// One or three points on each of the parts of a face: exact for polynomials of degree 1 or 2.
std::vector<FacePlace> places_on_parts(int order, int face, int points_per_part) {
  const Barycentric nodes = reference_nodes(order);
  std::vector<FacePlace> places;
  for (const Triangle& part : parts_of_face(order, face)) {
    for (int i = 0; i < points_per_part; ++i) {
      const double own = points_per_part == 1 ? 1.0 / 3 : 2.0 / 3;
      places.push_back(
          {own * nodes.row(part[i]) + (1 - own) / 2 * (nodes.row(part[(i + 1) % 3]) + nodes.row(part[(i + 2) % 3])),
           1.0 / (order * order * points_per_part)});
    }
  }
  return places;
}

// Gauss and Legendre's n points in (0, 1) with their weights, exact to degree 2n - 1, by Newton's method.
std::vector<std::array<double, 2>> gauss_points(int n) {
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
    for (int step = 0; step < 20; ++step) {
      double before = 1, value = x;
      for (int k = 2; k <= n; ++k) before = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * before) / k);
      slope = n * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    points.push_back({(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)});
  }
  return points;
}

// The flow through a face of order p has degree p from the shape functions and 2 (p - 1) from the face's geometry. The
// triangle is treated as a square with one side collapsed to a point, which adds one degree in one direction.
std::vector<FacePlace> places_for_flow(int order, int face) {
  const auto& [a, b, c] = kTetFaces[face];
  const std::vector<std::array<double, 2>> points = gauss_points((3 * order + 1) / 2);
  std::vector<FacePlace> places;
  for (const auto& [u, u_weight] : points) {
    for (const auto& [v, v_weight] : points) {
      Eigen::Vector4d at = Eigen::Vector4d::Zero();
      at[a] = 1 - u;
      at[b] = u * (1 - v);
      at[c] = u * v;
      places.push_back({at, 2 * u * u_weight * v_weight});
    }
  }
  return places;
}

std::vector<PointOnFace> points_on_face(int order, int face, const std::vector<FacePlace>& wanted) {
  const Barycentric places = reference_nodes(order);
  const auto& [a, b, c] = kTetFaces[face];
  std::vector<int> on_face;
  for (int n = 0; n < places.rows(); ++n) {
    if (places(n, face) < 0.5 / order) on_face.push_back(n);
  }
  const auto free = [](int corner) {  // coordinates l1, l2, l3 of a corner
    return corner == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(Eigen::Vector3d::Unit(corner - 1));
  };
  std::vector<PointOnFace> points;
  for (const auto& [at, weight] : wanted) {
    const ReferenceGradient gradient = interpolation_gradient(order, at);
    Eigen::Matrix<double, Eigen::Dynamic, 2> sides(places.rows(), 2);
    sides << gradient * (free(b) - free(a)), gradient * (free(c) - free(a));
    points.push_back({on_face, interpolation(order, at), std::move(sides), weight});
  }
  return points;
}

// `points` has the points of an element's four faces.
SurfaceQuadrature quadrature_at(const Boundary& surface, const TetMesh& mesh,
                                const std::array<std::vector<PointOnFace>, 4>& points) {
  const std::vector<OuterFace> faces = outer_faces(mesh.elements);
  const auto count = static_cast<Eigen::Index>(faces.size() * points[0].size());
  SurfaceQuadrature found{.interpolation = {count, static_cast<Eigen::Index>(surface.nodes.size())},
                          .normals = Points(count, 3),
                          .areas = Eigen::VectorXd(count)};
  std::vector<Eigen::Triplet<double>> weights;
  Eigen::Index row = 0;
  for (const OuterFace& face : faces) {
    const auto element = mesh.elements.row(face.element);
    const ElementNodes nodes = nodes_of(mesh, face.element);
    std::array<Eigen::Index, nodes_per_element(kMaxOrder)> column{};
    for (const int n : points[face.opposite].front().nodes) {
      column[n] = std::lower_bound(surface.nodes.begin(), surface.nodes.end(), element[n]) - surface.nodes.begin();
    }
    for (const PointOnFace& point : points[face.opposite]) {
      for (const int n : point.nodes) weights.emplace_back(row, column[n], point.values[n]);
      const Eigen::Matrix<double, 2, 3> sides = point.sides.transpose() * nodes;
      const Eigen::Vector3d normal = Eigen::Vector3d(sides.row(0)).cross(Eigen::Vector3d(sides.row(1)));
      found.areas[row] = 0.5 * normal.norm() * point.weight;
      found.normals.row(row++) = normal.normalized();
    }
  }
  found.interpolation.setFromTriplets(weights.begin(), weights.end());
  return found;
}

}  // namespace

std::vector<OuterFace> outer_faces(const Indices& elements) {
  std::vector<OuterFace> faces;
  faces.reserve(4 * static_cast<std::size_t>(elements.rows()));
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    for (int f = 0; f < 4; ++f) {
      const auto& [a, b, c] = kTetFaces[f];
      faces.push_back({sorted({elements(e, a), elements(e, b), elements(e, c)}), e, f});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const OuterFace& a, const OuterFace& b) { return a.corners < b.corners; });
  std::vector<OuterFace> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next].corners == faces[i].corners) ++next;
    if (next == i + 1) outer.push_back(faces[i]);
    i = next;
  }
  return outer;
}

Boundary boundary_of(const TetMesh& mesh) {
  std::array<std::vector<Triangle>, 4> parts;
  for (int f = 0; f < 4; ++f) parts[f] = parts_of_face(mesh.order(), f);
  std::vector<Triangle> outer;
  for (const OuterFace& face : outer_faces(mesh.elements)) {
    const auto element = mesh.elements.row(face.element);
    for (const auto& [a, b, c] : parts[face.opposite]) {
      outer.push_back(lowest_first({element[a], element[b], element[c]}));
    }
  }
  return number_points(outer);
}

SurfaceQuadrature quadrature_of(const Boundary& surface, const TetMesh& mesh, int points_per_triangle) {
  assert(points_per_triangle == 1 || points_per_triangle == 3);
  std::array<std::vector<PointOnFace>, 4> points;
  for (int f = 0; f < 4; ++f)
    points[f] = points_on_face(mesh.order(), f, places_on_parts(mesh.order(), f, points_per_triangle));
  return quadrature_at(surface, mesh, points);
}

SurfaceQuadrature flow_quadrature_of(const Boundary& surface, const TetMesh& mesh) {
  std::array<std::vector<PointOnFace>, 4> points;
  for (int f = 0; f < 4; ++f) points[f] = points_on_face(mesh.order(), f, places_for_flow(mesh.order(), f));
  return quadrature_at(surface, mesh, points);
}

std::vector<double> area_weights(const Boundary& surface, const Points& nodes) {
  std::vector<double> weights(surface.nodes.size(), 0.0);
  for (const auto& triangle : surface.triangles) {
    const Eigen::Vector3d a = nodes.row(surface.nodes[triangle[0]]), b = nodes.row(surface.nodes[triangle[1]]),
                          c = nodes.row(surface.nodes[triangle[2]]);
    for (const std::uint32_t point : triangle) weights[point] += (b - a).cross(c - a).norm();
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

TriangleMesh skin_of(const TetMesh& mesh) {
  const Boundary surface = boundary_of(mesh);
  TriangleMesh skin;
  skin.nodes.resize(static_cast<Eigen::Index>(surface.nodes.size()), 3);
  skin.triangles.resize(static_cast<Eigen::Index>(surface.triangles.size()), 3);
  for (std::size_t n = 0; n < surface.nodes.size(); ++n) {
    skin.nodes.row(static_cast<Eigen::Index>(n)) = mesh.nodes.row(surface.nodes[n]);
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      skin.triangles(static_cast<Eigen::Index>(t), i) = static_cast<std::int32_t>(surface.triangles[t][i]);
    }
  }
  return skin;
}

}  // namespace ringdown::mesh
