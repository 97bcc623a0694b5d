// A recipe to a bank: meshed as fine as it asks or as it needs, and again until its error holds. [worker]
//
// Where a geometry names no mesh size, one is chosen (body_shape.h). With recipe.error > 0 the bake is repeated until
// the estimated error (fem/error_estimate.h) of every mode in the band is below it:
//
//   a geometry is meshed again with its sizes times (error / estimate)^(1/(2p)), in bounded steps, p the order; where
//   that would take too many unknowns, the order rises instead;
//   a mesh from a file keeps its nodes: the order rises up to 4, then each element is split into eight.
//
// A bake stops before a round that would take more than recipe.max_unknowns unknowns.
//
// With recipe.preview the body is meshed coarsely instead, with elements of order 2, which takes a second or less.
#pragma once

#include "engine/bake/bake.h"
#include "engine/bake/bake_cost.h"
#include "engine/bake/body_shape.h"
#include "engine/bake/object_file.h"
#include "engine/mesh/body.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

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
  double wall_elements = 0;          // as in mesh::Body
  std::string question;              // whether the size can be meant; or empty
  std::optional<MeshChoice> choice;  // of the mesh size, where none was named
  std::vector<Round> rounds;         // one, or more with recipe.error; the last one made the bank
  double mesh_seconds = 0;
};

inline constexpr double kMaxChosenUnknowns = 150'000;  // that a chosen mesh size makes
inline constexpr int kMaxRounds = 6;

// A plan of a bake: the object is meshed, but not solved.
struct Forecast {
  std::optional<MeshChoice> choice;
  mesh::CheckedMesh mesh;
  mesh::Making making = mesh::Making::kRead;
  std::vector<std::string> notes;
  fem::Element element = fem::Element::kTet20;
  BakeCost cost;                // of the first round
  double mesh_processor_s = 0;  // 0 when the mesh comes from the cache
};

// Fails as meshing does, but not for lack of memory.
Result<Forecast> forecast(const ObjectRecipe& recipe, const modal::Material& material, const Progress& progress = {});

// Progress stages: "mesh" and those of bake(), from the second round on with the round and its error before them. Fails
// as meshing and bake() do, and when the error cannot be reached: the sentence names the one that was.
Result<BakedObject> bake_recipe(const ObjectRecipe& recipe, const modal::Material& material,
                                const Progress& progress = {});

// The recipe with the materials of its parts, and its liquids, in place of their names.
Result<ObjectRecipe> with_part_materials(ObjectRecipe recipe, const std::filesystem::path& materials);

// Bakes with the material of that name in `materials`, by bake_recipe(). A first progress stage, "mesh",
// comes before those of bake(); meshing cannot be cancelled while gmsh is at work. With a cache (recipe.options.cache),
// neither is done a second time for the same object.
Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress = {});

}  // namespace ringdown::bake
