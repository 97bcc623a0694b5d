// Objects as text: presets/objects/NAME.toml, and the way from one to its bank. [worker]
//
//   name = "tumbler"                 # default: the file's name
//   description = "A thin drinking glass"
//   material = "glass"               # a file of presets/materials
//   geometry = "tumbler.geo"         # or a surface or a mesh (mesh/body_reader.h); relative to this file
//   unit_m = 0.001                   # length of one unit of the geometry; default: what the file says, else 1
//   scale = 1.5                      # all lengths times this, once it is meshed; default 1
//   mesh_size_m = 0.006              # longest edge, where it is meshed; default: chosen by the band (mesh_choice.h)
//   error = "0.1%"                   # or 0.001: refine until every frequency is that good (refine.h)
//   element = "tet20"                # default; tet10, tet35, tet4, tet4-lumped
//   surface_points = 160             # default 200
//   band_hz = [20, 20000]            # default
//   keep_modes = 120                 # the most important ones; default: all in the band
//   floor_db = 60                    # drop what is inaudible this far below the loudest mode; default: nothing
//   gain_db = -3                     # the bank's gain, -60 ... 60: how loud beside other objects; default 0
//   budget_s = 20                    # processor seconds that a bake of it should not exceed; default: none
//   [parameters]                     # DefineConstant names of a .geo, in its unit
//   height = 110
#pragma once

#include "engine/bake/bake.h"
#include "engine/bake/material_library.h"
#include "engine/bake/mesh_choice.h"
#include "engine/base/range.h"
#include "engine/mesh/body_reader.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

struct ObjectRecipe {
  std::string name;
  std::string description;
  std::string material;
  std::filesystem::path geometry;
  mesh::GmshOptions meshing;
  BakeOptions options;
  double scale = 1;                       // the object is so many times as large as its geometry, whose mesh it keeps
  std::map<std::string, double> figures;  // of the material, by their keys in its file, instead of what stands there
  double gain_db = 0;
  double error = 0;  // relative, that the estimate for every frequency in the band must reach; 0: whatever it is
  double most_unknowns = 400'000;  // that `error` may lead to
  bool preview = false;            // coarse and quick; `error` does not count
  double budget_s = 0;             // of processor time, which `ringdown bake FOLDER` compares with; 0: none
};

inline constexpr Range kScale{1e-3, 1e3};
inline constexpr Range kError{1e-7, 0.5};  // that may be asked for

Result<ObjectRecipe> read_object(const std::filesystem::path& path);

// The same from memory; `path` is where the text would stand.
Result<ObjectRecipe> parse_object(std::string_view text, const std::filesystem::path& path);

// One bake of several that refine each other.
struct Round {
  fem::Element element = fem::Element::kTet20;
  Eigen::Index elements = 0, unknowns = 0;
  double error = 0;  // the largest estimate of any frequency in the band
};

struct BakedObject {
  Baked baked;
  mesh::CheckedMesh mesh;
  mesh::Making making = mesh::Making::kRead;
  std::vector<std::string> notes;    // what was found in a surface, and what was done about it
  std::string question;              // whether the size can be meant; or empty
  std::optional<MeshChoice> choice;  // of the mesh size, where none was named
  std::vector<Round> rounds;         // one, or more with recipe.error; the last one made the bank
  double mesh_seconds = 0;
};

// Bakes with the material of that name in `materials`, by bake_recipe() (refine.h). A first progress stage, "mesh",
// comes before those of bake(); meshing cannot be cancelled while gmsh is at work. With a cache (recipe.options.cache),
// neither is done a second time for the same object.
Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress = {});

}  // namespace ringdown::bake
