// Bodies for the tests of breaking, made without gmsh.
#pragma once

#include "tests/fem/sample_meshes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

namespace ringdown::test {

// Moves every node of a mesh, those inside curved elements, too.
template <class Map>
mesh::TetMesh moved(mesh::TetMesh mesh, const Map& map) {
  for (auto node : mesh.nodes.rowwise()) node = map(Eigen::Vector3d(node.transpose())).transpose();
  return mesh;
}

// Nodes in one place become one.
inline mesh::TetMesh welded(mesh::TetMesh mesh) {
  std::map<std::tuple<long, long, long>, std::int32_t> first;
  std::vector<std::int32_t> kept(mesh.nodes.rows());
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    const auto round = [&](int axis) { return std::lround(1e9 * mesh.nodes(n, axis)); };
    kept[n] = first.try_emplace({round(0), round(1), round(2)}, static_cast<std::int32_t>(n)).first->second;
  }
  for (std::int32_t& node : mesh.elements.reshaped()) node = kept[node];
  mesh::drop_unused_nodes(mesh.nodes, mesh.elements);
  return mesh;
}

// A square plate of 26 cm, 4.5 mm thick.
inline mesh::TetMesh plate(int cells) { return box_mesh({cells, cells, 1}, {0.26, 0.26, 0.0045}); }

// A tumbler without a bottom: 7 cm across, 10 cm high, its wall 2 mm thick. `around` is even.
inline mesh::TetMesh tube(int order, int around, int up) {
  const double length = 2 * std::numbers::pi;
  const mesh::TetMesh flat = mesh::to_order(box_mesh({around, up, 1}, {length, 0.1, 0.002}), order);
  return checked(welded(moved(flat,
                              [](const Eigen::Vector3d& at) {
                                const double radius = 0.035 - at[2];
                                return Eigen::Vector3d(radius * std::cos(at[0]), radius * std::sin(at[0]), at[1]);
                              })))
      .mesh;
}

// A bowl: a part of a spherical shell of radius 10 cm, 3 mm thick, with a square outline of 60 degrees to each side.
inline mesh::TetMesh bowl(int order, int cells) {
  const mesh::TetMesh flat = mesh::to_order(box_mesh({cells, cells, 1}, {2, 2, 0.003}), order);
  return checked(moved(flat,
                       [](const Eigen::Vector3d& at) {
                         const Eigen::Vector3d direction(std::tan(std::numbers::pi / 3 * (at[0] - 1)),
                                                         std::tan(std::numbers::pi / 3 * (at[1] - 1)), -1);
                         return Eigen::Vector3d((0.1 - at[2]) * direction.normalized());
                       }))
      .mesh;
}

struct Body {
  std::string name;
  mesh::TetMesh mesh;
};

}  // namespace ringdown::test
