// Meshes for tests, made without gmsh.
#pragma once

#include "engine/fem/assembly.h"
#include "engine/mesh/mesh_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace ringdown::test {

struct Cells {
  int x = 1, y = 1, z = 1;
};

// A box with one corner at the origin, six tetrahedra to a cell, diagonals mirrored from cell to cell.
inline mesh::TetMesh box_mesh(Cells cells, Eigen::Vector3d size) {
  mesh::TetMesh box;
  const auto number = [&](int i, int j, int k) { return (k * (cells.y + 1) + j) * (cells.x + 1) + i; };
  box.nodes.resize((cells.x + 1) * (cells.y + 1) * (cells.z + 1), 3);
  for (int k = 0; k <= cells.z; ++k) {
    for (int j = 0; j <= cells.y; ++j) {
      for (int i = 0; i <= cells.x; ++i) {
        box.nodes.row(number(i, j, k)) << size[0] * i / cells.x, size[1] * j / cells.y, size[2] * k / cells.z;
      }
    }
  }
  std::vector<std::array<int, 4>> elements;
  for (int cell = 0; cell < cells.x * cells.y * cells.z; ++cell) {
    const std::array<int, 3> at = {cell % cells.x, cell / cells.x % cells.y, cell / cells.x / cells.y};
    std::array<int, 3> order = {0, 1, 2};
    do {  // walk along the three axes in every order: from one corner of the cell to the opposite one
      std::array<int, 3> step = {0, 0, 0};
      std::array<int, 4> element{};
      for (int s = 0; s < 4; ++s) {
        if (s > 0) step[order[s - 1]] = 1;
        std::array<int, 3> node{};
        for (int a = 0; a < 3; ++a) node[a] = at[a] + (at[a] % 2 ? 1 - step[a] : step[a]);
        element[s] = number(node[0], node[1], node[2]);
      }
      elements.push_back(element);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  box.elements.resize(static_cast<Eigen::Index>(elements.size()), 4);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (int a = 0; a < 4; ++a) box.elements(static_cast<Eigen::Index>(e), a) = elements[e][a];
  }
  return mesh::check_mesh(box, "box").value().mesh;  // turns the half that is inside out
}

// A mesh from 0 on, with smaller elements at its far ends along an axis, or at the near one alone.
inline mesh::TetMesh finer_at_ends(mesh::TetMesh mesh, int axis, bool both) {
  constexpr double kPi = 3.14159265358979324;
  const double size = mesh.nodes.col(axis).maxCoeff();
  for (double& x : mesh.nodes.col(axis)) {
    const double s = x / size;
    x = size * (both ? s - 0.5 * std::sin(2 * kPi * s) / (2 * kPi) : s - 0.5 * std::sin(kPi * s) / kPi);
  }
  return mesh;
}

// The element with consistent mass that suits the mesh.
inline fem::Element element_of(const mesh::TetMesh& mesh) {
  constexpr std::array kElements = {fem::Element::kTet4, fem::Element::kTet10, fem::Element::kTet20,
                                    fem::Element::kTet35};
  return kElements[mesh.order() - 1];
}

inline mesh::CheckedMesh checked(const mesh::TetMesh& mesh) { return mesh::check_mesh(mesh, "test mesh").value(); }

// Every node moved at random by up to `amount` [m]. Edge nodes too, so that quadratic elements become curved.
inline mesh::TetMesh shaken(mesh::TetMesh mesh, double amount, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (double& coordinate : mesh.nodes.reshaped()) coordinate += shift(random);
  return mesh;
}

// A smooth bend: straight edges become arcs, volumes change, no element folds.
inline mesh::TetMesh bent(mesh::TetMesh mesh, double curvature) {
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    const double x = mesh.nodes(n, 0), z = mesh.nodes(n, 2), angle = curvature * x, radius = 1 / curvature + z;
    mesh.nodes(n, 0) = radius * std::sin(angle);
    mesh.nodes(n, 2) = radius * std::cos(angle) - 1 / curvature;
  }
  return mesh;
}

// Two meshes side by side in one, without a common node.
inline mesh::TetMesh both(const mesh::TetMesh& a, const mesh::TetMesh& b) {
  mesh::TetMesh joined;
  joined.nodes.resize(a.nodes.rows() + b.nodes.rows(), 3);
  joined.nodes << a.nodes, b.nodes;
  joined.elements.resize(a.elements.rows() + b.elements.rows(), a.elements.cols());
  joined.elements << a.elements, (b.elements.array() + static_cast<int>(a.nodes.rows())).matrix();
  return joined;
}

}  // namespace ringdown::test
