// The stages of a bake, each alone: mesh, assembly, factors, modes, surface. `./run bench bake` writes CSV. Counters:
// unknowns of the eigenproblem, modes found, systems solved.
#include "engine/bake/body_modes.h"
#include "engine/bake/object_file.h"
#include "engine/bake/sample_points.h"
#include "engine/materials/material_library.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/solve/eigensolver.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <numbers>

namespace {

using namespace ringdown;

bake::ObjectRecipe recipe(const std::string& name) {
  return bake::read_object(std::string(RINGDOWN_SOURCE_DIR) + "/presets/objects/" + name + ".toml").value();
}

const mesh::CheckedMesh& mesh_of(const std::string& name) {
  static std::map<std::string, mesh::CheckedMesh> meshes;
  const auto found = meshes.find(name);
  if (found != meshes.end()) return found->second;
  const bake::ObjectRecipe object = recipe(name);
  return meshes.emplace(name, mesh::read_with_gmsh(object.geometry, object.meshing).value()).first->second;
}

fem::Elastic elastic_of(const std::string& name) {
  const auto entry =
      bake::find_material(std::string(RINGDOWN_SOURCE_DIR) + "/presets/materials", recipe(name).material);
  const modal::Material& material = entry.value().material;
  return {material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3};
}

fem::System system_of(const std::string& name) {
  return fem::assemble(mesh_of(name).mesh, elastic_of(name), fem::Element::kTet10).value();
}

double lambda_of(double frequency_hz) { return std::pow(2 * std::numbers::pi * frequency_hz, 2); }

void mesh_with_gmsh(benchmark::State& state, const std::string& name) {
  const bake::ObjectRecipe object = recipe(name);
  for (auto _ : state) benchmark::DoNotOptimize(mesh::read_with_gmsh(object.geometry, object.meshing));
  state.counters["unknowns"] = static_cast<double>(3 * mesh_of(name).mesh.nodes.rows());
}

void assemble(benchmark::State& state, const std::string& name) {
  const mesh::CheckedMesh& mesh = mesh_of(name);
  const fem::Elastic elastic = elastic_of(name);
  for (auto _ : state) benchmark::DoNotOptimize(fem::assemble(mesh.mesh, elastic, fem::Element::kTet10));
  state.counters["unknowns"] = static_cast<double>(3 * mesh.mesh.nodes.rows());
}

// Times factors and iteration by the solver's own clocks, so that each stands alone.
void solve_timed(benchmark::State& state, const std::string& name, double top_hz, double solve::Eigenmodes::*seconds) {
  const fem::System system = system_of(name);
  for (auto _ : state) {
    const auto modes = solve::solve_modes(system, {.highest_lambda = lambda_of(top_hz)}).value();
    state.SetIterationTime(modes.*seconds);
    state.counters["modes"] = static_cast<double>(modes.lambda.size());
    state.counters["solves"] = modes.solves;
  }
  state.counters["unknowns"] = static_cast<double>(system.unknowns());
}

void surface_points(benchmark::State& state, const std::string& name) {
  const mesh::TetMesh mesh = mesh::to_order(mesh_of(name).mesh, 3);
  const mesh::Boundary surface = mesh::boundary_of(mesh);
  // Waves about a tenth of the body long stand for modes.
  const Eigen::VectorXd x = mesh.nodes.col(0) * 60 / bake::characteristic_length(mesh.nodes);
  Eigen::MatrixXd shapes(3 * static_cast<Eigen::Index>(surface.nodes.size()), 30);
  for (Eigen::Index row = 0; row < shapes.rows(); ++row) {
    for (Eigen::Index m = 0; m < shapes.cols(); ++m)
      shapes(row, m) = std::sin((1 + 0.03 * m) * x[surface.nodes[row / 3]] + row % 3);
  }
  for (auto _ : state) benchmark::DoNotOptimize(bake::choose_points(mesh, surface, shapes, {}));
}

// A preset without curvature, one with, and the largest.
BENCHMARK_CAPTURE(mesh_with_gmsh, plate, "steel-plate")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mesh_with_gmsh, bell, "bronze-bell")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(assemble, plate, "steel-plate")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(assemble, bell, "bronze-bell")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(assemble, glass, "wine-glass")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve_timed, factors_bell, "bronze-bell", 500.0, &solve::Eigenmodes::factor_seconds)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(solve_timed, factors_glass, "wine-glass", 400.0, &solve::Eigenmodes::factor_seconds)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(solve_timed, modes_plate, "steel-plate", 20e3, &solve::Eigenmodes::iterate_seconds)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(solve_timed, modes_bell, "bronze-bell", 10e3, &solve::Eigenmodes::iterate_seconds)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(solve_timed, modes_glass, "wine-glass", 20e3, &solve::Eigenmodes::iterate_seconds)
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(surface_points, bell, "bronze-bell")->Unit(benchmark::kMillisecond);

}  // namespace
