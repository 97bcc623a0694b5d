#include "tests/bench/modal/bodies.h"

#include "engine/materials/material_library.h"
#include "engine/mesh/gmsh_reader.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/fem/sample_meshes.h"

#include <cstdio>
#include <utility>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RINGDOWN_SOURCE_DIR;
constexpr double kMillimetre = 0.001;

template <std::size_t kCount>
std::vector<double> list(const std::array<double, kCount>& values) {
  return {values.begin(), values.end()};
}

Body box(const std::string& name, const std::string& material, const Eigen::Vector3d& size_m,
         std::vector<double> exact_hz) {
  const Eigen::Vector3d mm = size_m / kMillimetre;
  return {name,
          material,
          kRoot / "tests/bench/modal/materials",
          kRoot / "tests/bench/modal/box.geo",
          {{"length", mm[0]}, {"width", mm[1]}, {"thickness", mm[2]}},
          size_m,
          std::move(exact_hz)};
}

std::vector<Body> all_bodies() {
  return {box("block", "reference", {0.1, 0.08, 0.06}, list(reference::kBlock)),
          box("soft-block", "reference-soft", {0.1, 0.08, 0.06}, list(reference::kSoftBlock)),
          box("plate", "reference", {0.2, 0.2, 0.004}, list(reference::kPlate)),
          box("bar", "reference", {0.2, 0.01, 0.01}, list(reference::kBar)),
          {.name = "sphere",
           .material = "reference",
           .materials = kRoot / "tests/bench/modal/materials",
           .geometry = kRoot / "tests/bench/modal/sphere.geo",
           .exact_hz = list(reference::kSphere)},
          {.name = "bell",
           .material = "bronze",
           .materials = kRoot / "presets/materials",
           .geometry = kRoot / "presets/objects/bronze-bell.geo",
           .parameters = {{"diameter", 300}}}};
}

}  // namespace

Result<Body> find_body(const std::string& name) {
  std::string known;
  for (Body& body : all_bodies()) {
    if (body.name == name) return std::move(body);
    known += " " + body.name;
  }
  return fail(ErrorKind::bad_input, "there is no body " + name + "; there are" + known);
}

Result<fem::Elastic> elastic_of(const Body& body) {
  const auto entry = bake::find_material(body.materials, body.material);
  if (!entry) return fail(entry.error());
  const modal::Material& material = entry->material;
  return fem::Elastic{material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3};
}

Result<mesh::TetMesh> mesh_of(const Body& body, const std::string& mesh, int order) {
  test::Cells cells;
  if (std::sscanf(mesh.c_str(), "%dx%dx%d", &cells.x, &cells.y, &cells.z) == 3) {
    if (body.box_m.isZero()) return fail(ErrorKind::bad_input, body.name + " is no box, which cells are for");
    return mesh::to_order(test::box_mesh(cells, body.box_m), order);
  }
  const double size_mm = std::atof(mesh.c_str());
  if (!(size_mm > 0)) return fail(ErrorKind::bad_input, "a mesh is cells like 4x3x2, or a length in mm, not " + mesh);
  const auto read = mesh::read_with_gmsh(
      body.geometry,
      {.unit_m = kMillimetre, .mesh_size_m = size_mm * kMillimetre, .order = order, .parameters = body.parameters});
  if (!read) return fail(read.error());
  return read->mesh;
}

bake::ObjectRecipe default_recipe(const Body& body) {
  bake::ObjectRecipe recipe;
  recipe.name = body.name;
  recipe.material = body.material;
  recipe.geometry = body.geometry;
  recipe.meshing.order = fem::order_of(recipe.options.element);
  recipe.meshing.unit_m = kMillimetre;
  recipe.meshing.parameters = body.parameters;
  return recipe;
}

}  // namespace ringdown::bench
