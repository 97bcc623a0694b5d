#include "tests/stress/hard_meshes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <map>
#include <numbers>

namespace ringdown::test {
namespace {

// Outward, unnormalised: half of the parallelogram's are the face's area.
Eigen::RowVector3d face_normal(const mesh::Corners& corners, int opposite) {
  const auto& [a, b, c] = mesh::kTetFaces[opposite];
  return (corners.row(b) - corners.row(a)).cross(corners.row(c) - corners.row(a));
}

mesh::Indices without_rows_of_other_cells(const mesh::Indices& elements, const std::vector<int>& cells) {
  constexpr int kPerCell = 6;
  mesh::Indices kept(kPerCell * static_cast<Eigen::Index>(cells.size()), elements.cols());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    kept.middleRows<kPerCell>(kPerCell * static_cast<Eigen::Index>(c)) =
        elements.middleRows<kPerCell>(kPerCell * cells[c]);
  }
  return kept;
}

mesh::TetMesh box_with_lifted_slivers(Cells cells, const Eigen::Vector3d& size, double lift) {
  const Eigen::Vector3d half = size.cwiseProduct(Eigen::Vector3d(1, 1, 0.5));
  const mesh::TetMesh lower = box_mesh({cells.x, cells.y, cells.z / 2}, half);
  mesh::TetMesh upper = lower;  // mirrored in x: where x + y is odd, not even, begin the diagonals
  upper.nodes.col(0) = size[0] - upper.nodes.col(0).array();
  upper.nodes.col(2).array() += half[2];
  mesh::TetMesh box = welded(both(lower, upper));

  std::vector<std::vector<std::int32_t>> middle(cells.x + 1, std::vector<std::int32_t>(cells.y + 1));
  for (Eigen::Index n = 0; n < box.nodes.rows(); ++n) {
    if (std::abs(box.nodes(n, 2) - half[2]) > 1e-6 * size[2]) continue;
    const auto i = std::lround(box.nodes(n, 0) / size[0] * cells.x);
    const auto j = std::lround(box.nodes(n, 1) / size[1] * cells.y);
    middle[i][j] = static_cast<std::int32_t>(n);
    if ((i + j) % 2 == 1) box.nodes(n, 2) += lift;
  }
  Eigen::Index e = box.elements.rows();
  box.elements.conservativeResize(e + Eigen::Index{cells.x} * cells.y, 4);
  for (int i = 0; i < cells.x; ++i) {
    for (int j = 0; j < cells.y; ++j, ++e) {
      box.elements.row(e) << middle[i][j], middle[i + 1][j], middle[i + 1][j + 1], middle[i][j + 1];
    }
  }
  return checked(box).mesh;
}

struct Sphere {
  std::vector<Eigen::RowVector3d> directions;
  std::vector<std::array<int, 3>> triangles;
};

Sphere icosahedron() {
  const double g = std::numbers::phi;
  Sphere sphere;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) {
      for (int axis = 0; axis < 3; ++axis) {
        Eigen::RowVector3d at;
        at[axis] = 0, at[(axis + 1) % 3] = s, at[(axis + 2) % 3] = t;
        sphere.directions.push_back(at.normalized());
      }
    }
  }
  const double edge = 2 / std::sqrt(1 + g * g);
  const auto close = [&](int a, int b) { return (sphere.directions[a] - sphere.directions[b]).norm() < 1.1 * edge; };
  for (int a = 0; a < 12; ++a) {
    for (int b = a + 1; b < 12; ++b) {
      for (int c = b + 1; c < 12; ++c) {
        if (close(a, b) && close(b, c) && close(c, a)) sphere.triangles.push_back({a, b, c});
      }
    }
  }
  return sphere;
}

Sphere parted(const Sphere& coarse) {
  Sphere fine{coarse.directions, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(fine.directions.size()));
    if (is_new) fine.directions.push_back((fine.directions[a] + fine.directions[b]).normalized());
    return found->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const auto& triangle : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      fine.triangles.push_back(triangle);
    }
  }
  return fine;
}

}  // namespace

double smallest_dihedral_degree(const mesh::TetMesh& mesh) {
  double smallest = 180;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::Corners corners = mesh::corners_of(mesh, e);
    for (const auto& [i, j] : mesh::kTetEdges) {
      const Eigen::RowVector3d a = face_normal(corners, i), b = face_normal(corners, j);
      const double angle = std::numbers::pi - std::atan2(a.cross(b).norm(), a.dot(b));
      smallest = std::min(smallest, angle * 180 / std::numbers::pi);
    }
  }
  return smallest;
}

double largest_aspect(const mesh::TetMesh& mesh) {
  double largest = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::Corners corners = mesh::corners_of(mesh, e);
    double longest = 0, widest = 0;
    for (const auto& [i, j] : mesh::kTetEdges) longest = std::max(longest, (corners.row(i) - corners.row(j)).norm());
    for (int k = 0; k < 4; ++k) widest = std::max(widest, face_normal(corners, k).norm());
    largest = std::max(largest, longest * widest / std::abs(mesh::jacobian(corners).determinant()));
  }
  return largest;
}

mesh::TetMesh welded(const mesh::TetMesh& mesh) {
  const double grid = 1e-9 * (mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff()).norm();
  std::map<std::array<long, 3>, std::int32_t> number_at;
  mesh::TetMesh joined{mesh::Points(mesh.nodes.rows(), 3), mesh.elements};
  std::vector<std::int32_t> number;
  for (const auto& node : mesh.nodes.rowwise()) {
    const std::array place = {std::lround(node[0] / grid), std::lround(node[1] / grid), std::lround(node[2] / grid)};
    const auto [found, is_new] = number_at.try_emplace(place, static_cast<std::int32_t>(number_at.size()));
    joined.nodes.row(found->second) = node;
    number.push_back(found->second);
  }
  joined.nodes.conservativeResize(static_cast<Eigen::Index>(number_at.size()), 3);
  for (std::int32_t& node : joined.elements.reshaped()) node = number[node];
  return joined;
}

mesh::TetMesh box_with_slivers(Cells cells, const Eigen::Vector3d& size, double degree) {
  double low = 0, high = 0.3 * size[2] / cells.z;
  for (int step = 0; step < 40; ++step) {  // the angle grows with the lift
    const double lift = 0.5 * (low + high);
    (smallest_dihedral_degree(box_with_lifted_slivers(cells, size, lift)) < degree ? low : high) = lift;
  }
  return box_with_lifted_slivers(cells, size, high);
}

mesh::TetMesh with_thin_layer(mesh::TetMesh box, int axis, int layers, double share) {
  const double size = box.nodes.col(axis).maxCoeff(), middle = layers / 2;
  const double thin = size / layers * share, others = (size - thin) / (layers - 1);
  for (double& x : box.nodes.col(axis)) {
    const double layer = std::round(x / size * layers);
    x = layer <= middle ? others * layer : others * (layer - 1) + thin;
  }
  return box;
}

mesh::TetMesh hollow_sphere(double inner_m, double outer_m, int level, int order) {
  Sphere sphere = icosahedron();
  for (int l = 0; l < level; ++l) sphere = parted(sphere);
  const auto count = static_cast<int>(sphere.directions.size());
  mesh::TetMesh straight{mesh::Points(2 * count, 3), mesh::Indices(3 * std::ssize(sphere.triangles), 4)};
  for (int n = 0; n < count; ++n) {
    straight.nodes.row(n) = inner_m * sphere.directions[n];
    straight.nodes.row(count + n) = outer_m * sphere.directions[n];
  }
  Eigen::Index e = 0;
  for (std::array<int, 3> t : sphere.triangles) {
    std::sort(t.begin(), t.end());  // so that neighbours part their common face alike
    straight.elements.row(e++) << t[0], t[1], t[2], count + t[2];
    straight.elements.row(e++) << t[0], t[1], count + t[1], count + t[2];
    straight.elements.row(e++) << t[0], count + t[0], count + t[1], count + t[2];
  }
  mesh::TetMesh curved = mesh::to_order(checked(straight).mesh, order);
  const mesh::Barycentric lattice = mesh::reference_nodes(order);
  for (Eigen::Index k = 0; k < curved.elements.rows(); ++k) {
    Eigen::Vector4d radius;
    for (int a = 0; a < 4; ++a) radius[a] = curved.elements(k, a) < count ? inner_m : outer_m;
    for (Eigen::Index a = 4; a < lattice.rows(); ++a) {
      auto node = curved.nodes.row(curved.elements(k, a));
      node *= lattice.row(a).dot(radius) / node.norm();
    }
  }
  return curved;
}

mesh::TetMesh cubes(const std::vector<std::array<int, 3>>& cells, double edge_m) {
  std::array<int, 3> last = {0, 0, 0};
  for (const auto& cell : cells) {
    for (int a = 0; a < 3; ++a) last[a] = std::max(last[a], cell[a] + 1);
  }
  mesh::TetMesh grid = box_mesh({last[0], last[1], last[2]}, edge_m * Eigen::Vector3d(last[0], last[1], last[2]));
  std::vector<int> numbers;
  for (const auto& [x, y, z] : cells) numbers.push_back((z * last[1] + y) * last[0] + x);
  grid.elements = without_rows_of_other_cells(grid.elements, numbers);
  return grid;
}

mesh::TetMesh one_element(int order) {
  mesh::TetMesh mesh{mesh::Points(4, 3), mesh::Indices(1, 4)};
  mesh.nodes << 0, 0, 0, 0.1, 0, 0, 0.02, 0.09, 0, 0.03, 0.02, 0.08;
  mesh.elements << 0, 1, 2, 3;
  return mesh::to_order(mesh, order);
}

}  // namespace ringdown::test
