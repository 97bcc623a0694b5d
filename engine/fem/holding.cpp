#include "engine/fem/holding.h"

#include "engine/base/groups.h"
#include "engine/base/triangle.h"
#include "engine/dense/decompositions.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>

namespace ringdown::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Gauss's points and weights on (0, 1), from the three-term recurrence of Legendre's polynomials (Golub & Welsch, Math.
// Comp. 23, 1969).
struct GaussRule {
  explicit GaussRule(int count) {
    MatrixXd jacobi = MatrixXd::Zero(count, count);
    for (int k = 1; k < count; ++k) jacobi(k, k - 1) = k / std::sqrt(4.0 * k * k - 1);
    const dense::Spectrum solved = dense::spectrum(jacobi);
    points = (1 + solved.values.array()) / 2;
    weights = solved.vectors.row(0).array().square();
  }
  Eigen::ArrayXd points, weights;
};

Vector3d free_place(int corner) { return corner == 0 ? Vector3d::Zero() : Vector3d(Vector3d::Unit(corner - 1)); }

void add_face(const mesh::TetMesh& mesh, const Layer& layer, const mesh::OuterFace& face, System& system) {
  const mesh::ElementNodes nodes = nodes_of(mesh, face.element);
  const Eigen::Index count = nodes.rows();
  MatrixXd mass = MatrixXd::Zero(count, count);
  std::vector<Matrix3d> stiffness(static_cast<std::size_t>(count * count), Matrix3d::Zero());
  for (const FacePoint& point : points_on_face(nodes, face.opposite)) {
    const Eigen::VectorXd shape = mesh::interpolation(mesh.order(), point.barycentric);
    const Matrix3d at = point.area * stiffness_at(layer, point);
    mass += layer.mass_kg_m2 * point.area * shape * shape.transpose();
    for (Eigen::Index b = 0; b < count; ++b) {
      for (Eigen::Index a = 0; a < count; ++a) stiffness[a + b * count] += shape[a] * shape[b] * at;
    }
  }
  const auto own = mesh.elements.row(face.element);
  for (Eigen::Index b = 0; b < count; ++b) {
    for (Eigen::Index a = 0; a < count; ++a) {
      if (mass(a, b) != 0) system.node_mass.coeffRef(own[a], own[b]) += mass(a, b);
      const Matrix3d& block = stiffness[a + b * count];
      if (block.isZero(0)) continue;
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const Eigen::Index row = 3 * own[a] + i, column = 3 * own[b] + j;
          if (row >= column) system.stiffness.coeffRef(row, column) += block(i, j);
        }
      }
    }
  }
}

// The number of each node after the nodes in `gone` are removed; -1 for a removed node.
std::vector<std::int32_t> places_left(Eigen::Index count, const std::vector<std::int32_t>& gone) {
  std::vector<std::int32_t> place(static_cast<std::size_t>(count));
  auto next = gone.begin();
  for (std::int32_t n = 0, left = 0; n < count; ++n) {
    const bool is_gone = next != gone.end() && *next == n;
    place[n] = is_gone ? -1 : left++;
    if (is_gone) ++next;
  }
  return place;
}

// The entries between nodes that stay, with `per` unknowns per node.
SparseMatrix part_of(const SparseMatrix& whole, const std::vector<std::int32_t>& place, int per, Eigen::Index size) {
  SparseMatrix part(size, size);
  Eigen::VectorXi counts = Eigen::VectorXi::Zero(size);
  const auto to = [&](Eigen::Index index) {
    const std::int32_t node = place[index / per];
    return node < 0 ? Eigen::Index{-1} : per * Eigen::Index{node} + index % per;
  };
  for (const bool fill : {false, true}) {
    if (fill) part.reserve(counts);
    for (Eigen::Index column = 0; column < whole.outerSize(); ++column) {
      const Eigen::Index into = to(column);
      if (into < 0) continue;
      for (SparseMatrix::InnerIterator entry(whole, column); entry; ++entry) {
        const Eigen::Index row = to(entry.row());
        if (row < 0) continue;
        if (fill) part.insert(row, into) = entry.value();
        if (!fill) ++counts[into];
      }
    }
  }
  part.makeCompressed();
  return part;
}

// The piece of the mesh to which each node belongs, by the corners of elements.
std::vector<std::int32_t> pieces_of(const mesh::TetMesh& mesh) {
  Groups<std::int32_t> pieces(static_cast<std::size_t>(mesh.nodes.rows()));
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const std::int32_t node : mesh.elements.row(e)) pieces.join_to(node, mesh.elements(e, 0));
  }
  std::vector<std::int32_t> root(static_cast<std::size_t>(mesh.nodes.rows()));
  for (std::int32_t n = 0; n < mesh.nodes.rows(); ++n) root[n] = pieces.root(n);
  return root;
}

using Motions = Eigen::Matrix<double, 6, 6>;

// Adds the motions, of three shifts and three turns about `middle`, that a face resists.
void add_resistance(const mesh::TetMesh& mesh, const mesh::OuterFace& face, const Layer* layer, const Vector3d& middle,
                    double length, Motions& resisted) {
  const mesh::ElementNodes nodes = nodes_of(mesh, face.element);
  for (const FacePoint& point : points_on_face(nodes, face.opposite)) {
    const Vector3d arm = (nodes.transpose() * mesh::interpolation(mesh.order(), point.barycentric) - middle) / length;
    Eigen::Matrix<double, 3, 6> motion;
    motion.leftCols<3>().setIdentity();
    for (int k = 0; k < 3; ++k) motion.col(3 + k) = Vector3d::Unit(k).cross(arm);
    Matrix3d kind = Matrix3d::Identity();
    if (layer) {
      const Vector3d n = layer->direction.value_or(point.normal);
      kind = (layer->tangential_n_m3 > 0 ? 1.0 : 0.0) * (Matrix3d::Identity() - n * n.transpose());
      if (layer->normal_n_m3 > 0) kind += n * n.transpose();
    }
    resisted += point.area * motion.transpose() * kind * motion;
  }
}

}  // namespace

Matrix3d stiffness_at(const Layer& layer, const FacePoint& point) {
  const Vector3d n = layer.direction.value_or(point.normal);
  return layer.tangential_n_m3 * Matrix3d::Identity() + (layer.normal_n_m3 - layer.tangential_n_m3) * n * n.transpose();
}

std::vector<FacePoint> points_on_face(const mesh::ElementNodes& nodes, int opposite) {
  const int order = mesh::order_of_nodes(nodes.rows());
  const GaussRule rule(order + 2);
  const auto& [a, b, c] = mesh::kTetFaces[opposite];
  std::vector<FacePoint> points;
  for (Eigen::Index i = 0; i < rule.points.size(); ++i) {
    for (Eigen::Index j = 0; j < rule.points.size(); ++j) {
      const double u = rule.points[i], v = (1 - u) * rule.points[j];  // the square folded onto the triangle
      FacePoint& point = points.emplace_back();
      point.barycentric.setZero();
      point.barycentric[a] = 1 - u - v;
      point.barycentric[b] = u;
      point.barycentric[c] = v;
      const mesh::ReferenceGradient gradient = mesh::interpolation_gradient(order, point.barycentric);
      const Matrix3d slopes = (nodes.transpose() * gradient).eval();
      const Vector3d across =
          (slopes * (free_place(b) - free_place(a))).cross(slopes * (free_place(c) - free_place(a)));
      point.normal = across.normalized();
      point.area = rule.weights[i] * rule.weights[j] * (1 - u) * across.norm();
    }
  }
  return points;
}

Extent extent_of(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces) {
  Extent extent;
  for (const mesh::OuterFace& face : faces) {
    for (const FacePoint& point : points_on_face(nodes_of(mesh, face.element), face.opposite)) {
      extent.area += point.area;
      extent.normal += point.area * point.normal;
    }
  }
  if (extent.area > 0) extent.normal /= extent.area;
  return extent;
}

void add_layers(const mesh::TetMesh& mesh, const Holding& holding, System& system) {
  for (const Layer& layer : holding.layers) {
    for (const mesh::OuterFace& face : layer.faces) add_face(mesh, layer, face, system);
  }
  for (const HeldPoint& point : holding.points) {
    if (point.mass_kg == 0) continue;
    const Eigen::VectorXd shape = mesh::interpolation(mesh.order(), point.barycentric);
    const auto own = mesh.elements.row(point.element);
    for (Eigen::Index b = 0; b < shape.size(); ++b) {
      for (Eigen::Index a = 0; a < shape.size(); ++a) {
        if (const double mass = point.mass_kg * shape[a] * shape[b]; mass != 0)
          system.node_mass.coeffRef(own[a], own[b]) += mass;
      }
    }
  }
}

HeldPoint nearest_point(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces,
                        const Eigen::Vector3d& point) {
  const auto vec3 = [](const Vector3d& v) { return Vec3{v[0], v[1], v[2]}; };
  HeldPoint nearest;
  double best = std::numeric_limits<double>::infinity();
  for (const mesh::OuterFace& face : faces) {
    std::array<Vec3, 3> corners;
    const auto& turned = mesh::kTetFaces[face.opposite];
    for (std::size_t i = 0; i < 3; ++i)
      corners[i] = vec3(mesh.nodes.row(mesh.elements(face.element, turned[i])).transpose());
    const std::array<double, 3> weights = nearest_on_triangle(vec3(point), corners);
    const double distance = length(at_weights(corners, weights) - vec3(point));
    if (distance >= best) continue;
    best = nearest.distance = distance;
    nearest.element = face.element;
    nearest.barycentric.setZero();
    for (std::size_t i = 0; i < 3; ++i) nearest.barycentric[turned[i]] = weights[i];
  }
  return nearest;
}

Eigen::MatrixXd motion_at(const mesh::TetMesh& mesh, const std::vector<HeldPoint>& points,
                          const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
  MatrixXd motion(static_cast<Eigen::Index>(points.size()), shapes.cols());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::VectorXd shape = mesh::interpolation(mesh.order(), points[k].barycentric);
    MatrixXd moved = MatrixXd::Zero(3, shapes.cols());
    for (Eigen::Index a = 0; a < shape.size(); ++a)
      moved += shape[a] * shapes.middleRows<3>(3 * Eigen::Index{mesh.elements(points[k].element, a)});
    motion.row(static_cast<Eigen::Index>(k)) = moved.colwise().squaredNorm();
  }
  return motion;
}

std::vector<std::int32_t> nodes_on(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces) {
  const mesh::Barycentric places = mesh::reference_nodes(mesh.order());
  std::vector<std::int32_t> nodes;
  for (const mesh::OuterFace& face : faces) {
    for (Eigen::Index n = 0; n < places.rows(); ++n) {
      if (places(n, face.opposite) < 0.5 / mesh.order()) nodes.push_back(mesh.elements(face.element, n));
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void remove_nodes(const std::vector<std::int32_t>& nodes, const System& whole, System& left) {
  const std::vector<std::int32_t> place = places_left(whole.node_mass.cols(), nodes);
  const Eigen::Index count = whole.node_mass.cols() - static_cast<Eigen::Index>(nodes.size());
  left.stiffness = part_of(whole.stiffness, place, 3, 3 * count);
  left.node_mass = part_of(whole.node_mass, place, 1, count);
}

MatrixXd with_nodes(const Eigen::Ref<const MatrixXd>& shapes, const std::vector<std::int32_t>& nodes) {
  const Eigen::Index count = shapes.rows() / 3 + static_cast<Eigen::Index>(nodes.size());
  const std::vector<std::int32_t> place = places_left(count, nodes);
  MatrixXd all = MatrixXd::Zero(3 * count, shapes.cols());
  for (Eigen::Index n = 0; n < count; ++n) {
    if (place[n] >= 0) all.middleRows<3>(3 * n) = shapes.middleRows<3>(3 * Eigen::Index{place[n]});
  }
  return all;
}

int free_motions(const mesh::TetMesh& mesh, const Holding& holding) {
  constexpr double kRank = 1e-10;  // of the largest; a clamped patch's resistance falls with the square of its size
  const std::vector<std::int32_t> piece = pieces_of(mesh);
  std::vector<std::int32_t> names = piece;
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const Vector3d middle = mesh.nodes.colwise().mean();
  const double length = (mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff()).norm();
  std::vector<Motions> resisted(names.size(), Motions::Zero());
  const auto add = [&](const std::vector<mesh::OuterFace>& faces, const Layer* layer) {
    for (const mesh::OuterFace& face : faces) {
      const auto at = std::lower_bound(names.begin(), names.end(), piece[mesh.elements(face.element, 0)]);
      add_resistance(mesh, face, layer, middle, length, resisted[at - names.begin()]);
    }
  };
  add(holding.clamped, nullptr);
  for (const Layer& layer : holding.layers) add(layer.faces, &layer);
  int free = 0;
  for (const Motions& matrix : resisted) {
    const Eigen::VectorXd values = dense::eigenvalues(matrix);
    free += static_cast<int>((values.array() <= kRank * values[5]).count());
  }
  return free;
}

MatrixXd motion_on(const mesh::TetMesh& mesh, const Layer& layer, const Eigen::Ref<const MatrixXd>& shapes) {
  MatrixXd sums = MatrixXd::Zero(2, shapes.cols());
  for (const mesh::OuterFace& face : layer.faces) {
    const auto own = mesh.elements.row(face.element);
    for (const FacePoint& point : points_on_face(nodes_of(mesh, face.element), face.opposite)) {
      const Eigen::VectorXd values = mesh::interpolation(mesh.order(), point.barycentric);
      MatrixXd at = MatrixXd::Zero(3, shapes.cols());
      for (Eigen::Index a = 0; a < values.size(); ++a) {
        if (values[a] != 0) at += values[a] * shapes.middleRows<3>(3 * Eigen::Index{own[a]});
      }
      const Vector3d n = layer.direction.value_or(point.normal);
      const Eigen::RowVectorXd along = (n.transpose() * at).array().square().matrix();
      sums.row(0) += point.area * along;
      sums.row(1) += point.area * (at.colwise().squaredNorm() - along);
    }
  }
  return sums;
}

}  // namespace ringdown::fem
