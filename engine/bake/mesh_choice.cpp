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

double thickness_of(const BodyShape& shape) {
  return shape.wall_m > 0 ? std::min(shape.wall_m, shape.thickness_m) : shape.thickness_m;
}

double shortest_wave(const BodyShape& shape, const modal::Material& material, double frequency_hz) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double shear = std::sqrt(e / (2 * (1 + nu) * rho)) / frequency_hz;
  const double omega = modal::hz_to_rad_per_s(frequency_hz), h = thickness_of(shape);
  const double bending_per_mass = e * h * h / (12 * (1 - nu * nu) * rho);  // D / (rho h)
  return std::min(shear, 2 * std::numbers::pi * std::pow(bending_per_mass, 0.25) / std::sqrt(omega));
}

double extent(const mesh::Points& nodes) { return (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).norm(); }

// Volume and its first and second moments.
class Moments {
 public:
  void add(const mesh::Corners& corners) {
    const double part = mesh::jacobian(corners).determinant() / 6;
    const Eigen::RowVector3d sum = corners.colwise().sum();
    volume_ += part;
    first_ += part / 4 * sum;
    second_ += part / 20 * (corners.transpose() * corners + sum.transpose() * sum);
  }

  [[nodiscard]] BodyShape shape(double area, double length_m) const {
    const Eigen::Matrix3d spread = second_ / volume_ - first_.transpose() * first_ / (volume_ * volume_);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread, Eigen::EigenvaluesOnly);
    return {.volume_m3 = std::abs(volume_),
            .thickness_m = 2 * std::abs(volume_) / area,
            .wall_m = 0,
            .width_m = std::sqrt(12 * std::max(principal.eigenvalues()[1], 0.0)),
            .length_m = length_m};
  }

 private:
  double volume_ = 0;
  Eigen::RowVector3d first_ = Eigen::RowVector3d::Zero();
  Eigen::Matrix3d second_ = Eigen::Matrix3d::Zero();
};

// The size that makes that many unknowns: the inverse of estimated_unknowns().
double size_for(const BodyShape& shape, double unknowns, int order) {
  const double cells = 8 * kUnknownsPerElement[order - 1] * shape.volume_m3 / unknowns;
  const double compact = std::cbrt(cells);
  return compact <= shape.thickness_m ? compact : std::sqrt(cells / shape.thickness_m);
}

}  // namespace

BodyShape measure_shape(const mesh::TetMesh& mesh) {
  Moments moments;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) moments.add(mesh::corners_of(mesh, e));
  return moments.shape(surface_area(mesh), extent(mesh.nodes));
}

// Tetrahedra from the origin to each triangle count with their sign.
BodyShape measure_shape(const mesh::TriangleMesh& skin, double wall_m) {
  Moments moments;
  double area = 0;
  const Eigen::RowVector3d middle = skin.nodes.colwise().mean();
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    mesh::Corners corners = mesh::Corners::Zero();
    for (int i = 0; i < 3; ++i) corners.row(i + 1) = skin.nodes.row(skin.triangles(t, i)) - middle;
    moments.add(corners);
    const Eigen::RowVector3d a = corners.row(1), b = corners.row(2), c = corners.row(3);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  BodyShape shape = moments.shape(area, extent(skin.nodes));
  shape.wall_m = wall_m;
  return shape;
}

double estimated_unknowns(const BodyShape& shape, double size_m, int order) {
  const double cell = size_m * size_m * std::min(size_m, shape.thickness_m) / 8;
  return kUnknownsPerElement[order - 1] * shape.volume_m3 / cell;
}

MeshChoice choose_mesh(const BodyShape& shape, const modal::Material& material, double band_high_hz, int order,
                       double most_unknowns) {
  MeshChoice choice{.shortest_wave_m = shortest_wave(shape, material, band_high_hz)};
  choice.size_m = std::min({choice.shortest_wave_m / kElementsPerWave[order - 1], kSizeInSection * shape.width_m,
                            (order + 1) * thickness_of(shape)});
  choice.wall_m = shape.wall_m;
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
