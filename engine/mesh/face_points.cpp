#include "engine/mesh/face_points.h"

#include "engine/mesh/boundary.h"

#include <Eigen/Geometry>

#include <array>

namespace ringdown::mesh {
namespace {

// Returns the element's nodes on the face opposite a corner, ascending.
std::vector<int> nodes_on_face(int order, int opposite) {
  const Barycentric places = reference_nodes(order);
  std::vector<int> nodes;
  for (int n = 0; n < places.rows(); ++n) {
    if (places(n, opposite) < 0.5 / order) nodes.push_back(n);
  }
  return nodes;
}

// Barycentric coordinates, on the face, of the middles of its nine parts.
std::array<Eigen::Vector3d, kPointsPerFace> middles() {
  std::array<Eigen::Vector3d, kPointsPerFace> points;
  constexpr int kParts = 3;
  int count = 0;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; i + j < kParts; ++j) {
      const Eigen::Vector3d low(i, j, kParts - 1 - i - j);
      points[count++] = (low.array() + 1.0 / 3) / kParts;
      if (low[2] > 0) points[count++] = (low + Eigen::Vector3d(2.0 / 3, 2.0 / 3, -1.0 / 3)) / kParts;
    }
  }
  return points;
}

Eigen::Vector3d free_coordinates(int corner) {
  return corner == 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(Eigen::Vector3d::Unit(corner - 1));
}

}  // namespace

FaceFunctions face_functions(int order, int opposite) {
  const std::vector<int> on_face = nodes_on_face(order, opposite);
  const auto& [a, b, c] = kTetFaces[opposite];
  const auto count = static_cast<Eigen::Index>(on_face.size());
  FaceFunctions functions{Eigen::MatrixXd(kPointsPerFace, count), Eigen::MatrixXd(kPointsPerFace, count),
                          Eigen::MatrixXd(kPointsPerFace, count)};
  Eigen::Index row = 0;
  for (const Eigen::Vector3d& middle : middles()) {
    Eigen::Vector4d at = Eigen::Vector4d::Zero();
    at[a] = middle[0];
    at[b] = middle[1];
    at[c] = middle[2];
    const Eigen::VectorXd values = interpolation(order, at);
    const ReferenceGradient gradient = interpolation_gradient(order, at);
    const Eigen::VectorXd second = gradient * (free_coordinates(b) - free_coordinates(a)),
                          third = gradient * (free_coordinates(c) - free_coordinates(a));
    for (Eigen::Index k = 0; k < count; ++k) {
      functions.values(row, k) = values[on_face[k]];
      functions.along_second(row, k) = second[on_face[k]];
      functions.along_third(row, k) = third[on_face[k]];
    }
    ++row;
  }
  return functions;
}

FacePoints face_points(const TetMesh& mesh) {
  const int order = mesh.order();
  std::array<std::vector<int>, 4> on_face;
  std::array<FaceFunctions, 4> functions;
  for (int f = 0; f < 4; ++f) {
    on_face[f] = nodes_on_face(order, f);
    functions[f] = face_functions(order, f);
  }
  const std::vector<OuterFace> faces = outer_faces(mesh.elements);
  const auto count = static_cast<Eigen::Index>(faces.size()), nodes = static_cast<Eigen::Index>(on_face[0].size());
  FacePoints points{.positions = Points(count * kPointsPerFace, 3),
                    .normals = Points(count * kPointsPerFace, 3),
                    .second = Points(count * kPointsPerFace, 3),
                    .third = Points(count * kPointsPerFace, 3),
                    .areas = Eigen::VectorXd(count * kPointsPerFace),
                    .nodes = Indices(count, nodes),
                    .opposite = {},
                    .elements = {}};
  Eigen::MatrixXd places(nodes, 3);
  for (Eigen::Index f = 0; f < count; ++f) {
    const auto& [corners, element, opposite] = faces[f];
    for (Eigen::Index k = 0; k < nodes; ++k) {
      points.nodes(f, k) = mesh.elements(element, on_face[opposite][k]);
      places.row(k) = mesh.nodes.row(points.nodes(f, k));
    }
    points.opposite.push_back(opposite);
    points.elements.push_back(element);
    const FaceFunctions& at = functions[opposite];
    points.positions.middleRows<kPointsPerFace>(f * kPointsPerFace) = at.values * places;
    points.second.middleRows<kPointsPerFace>(f * kPointsPerFace) = at.along_second * places;
    points.third.middleRows<kPointsPerFace>(f * kPointsPerFace) = at.along_third * places;
    for (Eigen::Index p = f * kPointsPerFace; p < (f + 1) * kPointsPerFace; ++p) {
      const Eigen::Vector3d normal = Eigen::Vector3d(points.second.row(p)).cross(Eigen::Vector3d(points.third.row(p)));
      points.areas[p] = 0.5 * normal.norm() / kPointsPerFace;
      points.normals.row(p) = normal.normalized();
    }
  }
  return points;
}

}  // namespace ringdown::mesh
