#include "engine/bake/mesh_choice.h"

#include "engine/mesh/surface.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ringdown::bake {
namespace {

constexpr std::array kElementsPerWave = {20.0, 8.0, 4.0, 2.5};      // order 1 to 4
constexpr std::array kUnknownsPerElement = {0.7, 6.0, 17.0, 38.0};  // gmsh's meshes of bodies, not of films
constexpr double kElementsPerThicknessAtEdges = 1;
constexpr double kSizeInSection = 0.33;  // of the width

double surface_area(const mesh::TetMesh& mesh) {
  const mesh::Surface surface = mesh::boundary_surface(mesh);
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::RowVector3d at = mesh.nodes.row(surface.nodes[a]);
    const Eigen::RowVector3d to_b = mesh.nodes.row(surface.nodes[b]) - at, to_c = mesh.nodes.row(surface.nodes[c]) - at;
    area += 0.5 * to_b.cross(to_c).norm();
  }
  return area;
}

double shortest_wave(const BodyShape& shape, const modal::Material& material, double frequency_hz) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double shear = std::sqrt(e / (2 * (1 + nu) * rho)) / frequency_hz;
  const double omega = modal::hz_to_rad_per_s(frequency_hz), h = shape.thickness_m;
  const double bending_per_mass = e * h * h / (12 * (1 - nu * nu) * rho);  // D / (rho h)
  return std::min(shear, 2 * std::numbers::pi * std::pow(bending_per_mass, 0.25) / std::sqrt(omega));
}

// The size that makes that many unknowns: the inverse of estimated_unknowns().
double size_for(const BodyShape& shape, double unknowns, int order) {
  const double cells = 8 * kUnknownsPerElement[order - 1] * shape.volume_m3 / unknowns;
  const double compact = std::cbrt(cells);
  return compact <= shape.thickness_m ? compact : std::sqrt(cells / shape.thickness_m);
}

}  // namespace

BodyShape measure_shape(const mesh::TetMesh& mesh) {
  double volume = 0;
  Eigen::RowVector3d first = Eigen::RowVector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::Corners corners = mesh::corners_of(mesh, e);
    const double part = mesh::jacobian(corners).determinant() / 6;
    const Eigen::RowVector3d sum = corners.colwise().sum();
    volume += part;
    first += part / 4 * sum;
    second += part / 20 * (corners.transpose() * corners + sum.transpose() * sum);
  }
  const Eigen::Matrix3d spread = second / volume - first.transpose() * first / (volume * volume);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread, Eigen::EigenvaluesOnly);
  return {.volume_m3 = volume,
          .thickness_m = 2 * volume / surface_area(mesh),
          .width_m = std::sqrt(12 * principal.eigenvalues()[1])};
}

double estimated_unknowns(const BodyShape& shape, double size_m, int order) {
  const double cell = size_m * size_m * std::min(size_m, shape.thickness_m) / 8;
  return kUnknownsPerElement[order - 1] * shape.volume_m3 / cell;
}

MeshChoice choose_mesh(const BodyShape& shape, const modal::Material& material, double band_high_hz, int order,
                       double most_unknowns) {
  MeshChoice choice{.shortest_wave_m = shortest_wave(shape, material, band_high_hz)};
  choice.size_m = std::min({choice.shortest_wave_m / kElementsPerWave[order - 1], kSizeInSection * shape.width_m,
                            (order + 1) * shape.thickness_m});
  const double finest = size_for(shape, most_unknowns, order);
  choice.bounded = choice.size_m < finest;
  choice.size_m = std::max(choice.size_m, finest);
  if (!choice.bounded) choice.edge_size_m = std::min(choice.size_m, shape.thickness_m / kElementsPerThicknessAtEdges);
  return choice;
}

MeshChoice choose_coarse_mesh(const BodyShape& shape, int order, double unknowns) {
  return {.size_m = size_for(shape, unknowns, order)};
}

}  // namespace ringdown::bake
