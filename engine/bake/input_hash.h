// One hash of everything that a bank is made from: where it is the same, the bank is the same. [any thread]
//
//   const std::optional<std::string> hash = input_hash({.object = "bell.toml", .geometry = "bell.geo", ...});
//   if (hash && modal::read_input_hash("bell.glb") == hash) ...nothing to do...
//
// In it are the content of every file, what the object is called, the options of the command line, and
// kBakesUnchangedSince (engine/base/version.h); not where the files lie, nor when they were written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

struct BankInputs {
  std::filesystem::path object;    // the file that was named: an object or a geometry
  std::filesystem::path geometry;  // may be the same
  std::filesystem::path material;
  std::vector<std::string> options;                        // that can change the bank, as words
  std::vector<std::filesystem::path> part_materials = {};  // of parts in a material of their own
  std::vector<std::filesystem::path> part_surfaces = {};   // that parts lie in
};

// Nothing when the files do not tell all: one cannot be read, or a .geo asks its surroundings (GetEnv, SystemCall, Rand
// and the like) or includes what it does not name by a plain text. Costs reading the files.
std::optional<std::string> input_hash(const BankInputs& inputs);

// A geometry and all it reads: what a .geo includes or merges, a .gltf refers to, and TetGen's files
// of the same name. Nothing where they cannot be known or are more than mesh::kMaxGeoFiles.
std::optional<std::vector<std::filesystem::path>> files_of_geometry(const std::filesystem::path& geometry);

}  // namespace ringdown::bake
