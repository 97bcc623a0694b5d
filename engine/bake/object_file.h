// Objects as text: presets/objects/NAME.toml, read and changed. bake_object.h makes a bank of one. [worker]
//
//   name = "tumbler"                 # default: the file's name
//   description = "A thin drinking glass"
//   material = "glass"               # a file of presets/materials
//   geometry = "tumbler.geo"         # or a surface or a mesh (mesh/body_reader.h); relative to this file
//   mesh_size_m = 0.006              # options of baking (recipe_options.h)
//   band_hz = [20, 20000]
//   pitch = "A4"                     # or 440, in Hz: the note that it is tuned to; default: found by its modes
//   [grain]                          # the material's axes (makeup.h); without, the material is isotropic
//   along = [1, 0, 0]                # of its grain
//   radial = [0, 0, 1]               # of its growth rings; needed for orthotropic materials
//   axis = [0, 0, 1]                 # instead of both: the grain runs along this axis, the radius away from it
//   through = [0, 0, 0]              # a point of the axis, in metres; default: the origin
//   winds = true                     # the grain runs around the axis; default false
//   [[part]]                         # elements of another material
//   group = "handle"                 # Physical Volume of the mesh or .geo
//   material = "maple"
//   grain = { along = [1, 0, 0], radial = [0, 0, 1] }    # as [grain]
//   [[support]]                      # what holds the body; any number of them
//   kind = "clamped"                 # or "slides", "springs"; "felt", "foam", "hand": springs with figures of their
//   own box = [0, 0, 0, 0.01, 0.1, 0.1]  # faces between two corners, in metres before `scale`; or: plane = [0, 0, 0,
//   0, 0, 1]       # faces on a plane: a point in metres, and the normal; or: group = "foot"                   #
//   Physical Surface stiffness = 1e9                  # of springs: N/m for each m^2 along the normal stiffness_along =
//   1e8            # along the surface; default: as along the normal damping = 1e4                    # N s/m for each
//   m^2; default 0 loss_factor = 0.1                # of the springs; default 0
//   [[support]]
//   kind = "cord"                    # or "felt", "foam", "hand": touches it at points
//   points = [0.1, 0, 0, 0.3, 0, 0]  # three numbers for each point, in metres before `scale`
//   damping = 1                      # N s/m, of each point; default 1, and 1, 0.3, 10 of the others
//   mass = 0                         # kg, of each point; default 0
//   [[mass]]                         # glued on, spread over a box, plane or group
//   mass_kg = 0.002
//   [fill]                           # a liquid in it, and [bath]: one around it (liquid/filling.h)
//   [[resonator]]                    # a tube under it (tubes/resonator.h)
//   [shatter]                        # it can break into pieces (docs/use/breaking.md)
//   pieces = [4, 14, 48]             # numbers of pieces, of one pattern each; default 30
//   pattern = "impact"               # or "radial", "uniform"
//   at = [0.1, 0, 0]                 # places of blows, three numbers each, in metres before `scale`; default: the
//                                    # middle of the surface
//   seed = 1                         # another seed, other pieces
//   min_mass_kg = 0                  # lighter pieces join a neighbour; default: 0.2 % of the body's mass
//   band_hz = [20, 20000]            # of the pieces
//   [parameters]                     # DefineConstant names of a .geo, in its unit; an option, too
//   height = 110
#pragma once

#include "engine/bake/recipe_options.h"
#include "engine/base/result.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::bake {

// The files of the materials that the recipe's parts have, and of its liquids.
std::vector<std::filesystem::path> part_materials(const ObjectRecipe& recipe, const std::filesystem::path& materials);

// The files of the surfaces that part it.
std::vector<std::filesystem::path> part_surfaces(const ObjectRecipe& recipe);

Result<ObjectRecipe> read_object(const std::filesystem::path& path);

// Reads an object from memory; `path` is where the text would stand.
Result<ObjectRecipe> parse_object(std::string_view text, const std::filesystem::path& path);

// Other figures for an object file, whose text otherwise stays as it is.
struct ObjectChanges {
  std::map<std::string, double> parameters;  // of [parameters]; new ones are added
  double mesh_size_m = 0;                    // 0: as it is
  std::filesystem::path geometry;            // as the file says it; empty: as it is
  std::optional<double> pitch_hz;            // a note where it is one; nothing: what the file states goes
  std::optional<double> level_m;             // of its [fill], in place of any other amount; nothing: as it is
};

// `text`, an object file, with these figures; its name goes, so that it is the new file's. Comments and order stay.
// Fails when it is not an object, or writes what changes in a way that is not understood (one key to a line, parameters
// in a table of their own).
Result<std::string> change_object(std::string_view text, const ObjectChanges& changes);

}  // namespace ringdown::bake
