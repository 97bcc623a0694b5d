// Objects as text: presets/objects/NAME.toml, and the way from one to its bank. [worker]
//
//   name = "tumbler"                 # default: the file's name
//   description = "A thin drinking glass"
//   material = "glass"               # a file of presets/materials
//   geometry = "tumbler.geo"         # or a mesh; relative to this file
//   unit_m = 0.001                   # length of one unit of the geometry; default 1
//   mesh_size_m = 0.006              # longest edge, for a geometry; default: gmsh's choice
//   element = "tet10"                # default; tet20, tet35, tet4, tet4-lumped
//   surface_points = 160             # default 200
//   band_hz = [20, 20000]            # default
//   keep_modes = 120                 # the most important ones; default: all in the band
//   floor_db = 60                    # drop what is inaudible this far below the loudest mode; default: nothing
//   gain_db = -3                     # the bank's gain, -60 ... 60: how loud beside other objects; default 0
//   [parameters]                     # DefineConstant names of a .geo, in its unit
//   height = 110
#pragma once

#include "engine/bake/bake.h"
#include "engine/bake/material_library.h"
#include "engine/mesh/gmsh_reader.h"

#include <filesystem>
#include <string>

namespace ringdown::bake {

struct ObjectRecipe {
  std::string name;
  std::string description;
  std::string material;
  std::filesystem::path geometry;
  mesh::GmshOptions meshing;
  BakeOptions options;
  double gain_db = 0;
};

Result<ObjectRecipe> read_object(const std::filesystem::path& path);

struct BakedObject {
  Baked baked;
  mesh::CheckedMesh mesh;
  double mesh_seconds = 0;
};

// Meshes, then bakes with the material of that name in `materials`. A first progress stage, "mesh", comes
// before those of bake(); meshing cannot be cancelled while gmsh is at work. With a cache (recipe.options.cache), neither
// is done a second time for the same object.
Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress = {});

} // namespace ringdown::bake
