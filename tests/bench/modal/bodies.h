// What the modal benchmark measures on: four bodies whose exact frequencies are known, and a bell.
#pragma once

#include "engine/bake/bake_object.h"
#include "engine/fem/elastic.h"
#include "engine/mesh/tet_mesh.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::bench {

struct Body {
  std::string name;      // block, soft-block (nu = 0.49), plate, bar, sphere, bell
  std::string material;  // a file of `materials`
  std::filesystem::path materials;
  std::filesystem::path geometry;
  std::map<std::string, double> parameters;  // of the geometry, in mm
  Eigen::Vector3d box_m{0, 0, 0};            // of boxes
  std::vector<double> exact_hz;              // elastic; empty for the bell
};

Result<Body> find_body(const std::string& name);

Result<fem::Elastic> elastic_of(const Body& body);

// `mesh` is "16x14x10": cells of a box, six tetrahedra each; or "12": by gmsh, longest edge in mm, curved elements.
Result<mesh::TetMesh> mesh_of(const Body& body, const std::string& mesh, int order);

// The body as ringdown-bake is given it when nobody asks for anything: no mesh size, no element.
bake::ObjectRecipe default_recipe(const Body& body);

}  // namespace ringdown::bench
