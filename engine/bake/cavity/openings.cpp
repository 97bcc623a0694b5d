#include "engine/bake/cavity/openings.h"

#include <Eigen/Geometry>

#include <array>
#include <map>

namespace ringdown::bake {
namespace {

// The way that each node of the skin has to go, P x 3.
Eigen::MatrixX3d ways_of(const mesh::TetMesh& mesh, const mesh::Boundary& skin, const Eigen::MatrixX3d& nodes) {
  constexpr int kPoints = 3;            // of each triangle
  constexpr double kCosSmooth = 0.766;  // between the normals of a node and of a triangle; below it lies an edge
  const mesh::SurfaceQuadrature curved = mesh::quadrature_of(skin, mesh, kPoints);
  const Eigen::MatrixX3d at = curved.interpolation * nodes;
  const auto count = static_cast<Eigen::Index>(skin.triangles.size());
  Eigen::MatrixX3d flat(count, 3), normals = Eigen::MatrixX3d::Zero(nodes.rows(), 3);
  Eigen::VectorXd gaps = Eigen::VectorXd::Zero(nodes.rows()), areas = gaps;
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto corner = [&](int i) -> Eigen::Vector3d { return nodes.row(skin.triangles[t][i]).transpose(); };
    flat.row(t) = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized().transpose();
    for (Eigen::Index s = t * kPoints; s < (t + 1) * kPoints; ++s) {
      const double area = curved.areas[s], gap = flat.row(t).dot(at.row(s) - corner(0).transpose());
      for (const auto n : skin.triangles[t]) {
        normals.row(n) += area * flat.row(t);
        gaps[n] += area * gap;
        areas[n] += area;
      }
    }
  }
  normals.rowwise().normalize();
  for (Eigen::Index t = 0; t < count; ++t) {
    for (const auto n : skin.triangles[t]) {
      if (normals.row(n).dot(flat.row(t)) < kCosSmooth) gaps[n] = 0;
    }
  }
  return gaps.cwiseQuotient(areas).asDiagonal() * normals;
}

}  // namespace

void keep_openings(const mesh::TetMesh& mesh, const mesh::Boundary& skin, mesh::TriangleMesh& surface) {
  const auto place = [](const auto& row) { return std::array{row[0], row[1], row[2]}; };
  std::map<std::array<double, 3>, Eigen::Index> numbers;
  Eigen::MatrixX3d nodes(static_cast<Eigen::Index>(skin.nodes.size()), 3);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    nodes.row(n) = mesh.nodes.row(skin.nodes[n]);
    numbers.emplace(place(nodes.row(n)), n);
  }
  const Eigen::MatrixX3d ways = ways_of(mesh, skin, nodes);
  for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
    const auto found = numbers.find(place(surface.nodes.row(n)));
    if (found != numbers.end()) surface.nodes.row(n) += ways.row(found->second);
  }
}

}  // namespace ringdown::bake
