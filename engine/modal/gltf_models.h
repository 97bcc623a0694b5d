// Adds modal models to a glTF file that another program wrote, and leaves everything else in the file as it is.
// [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::modal {

// A model, and the nodes that are to play it.
struct AddedModel {
  const Bank* bank = nullptr;  // its points as they lie in the nodes' own frames
  std::vector<std::size_t> nodes;
  std::optional<std::size_t> material;  // the number of an acoustic material of the file
};

struct ExtendedGltf {
  std::string file;                 // the new bytes of the .glb or .gltf
  std::string buffer_name, buffer;  // of a file beside it that must be there first; empty: none
};

// `file` with the models appended to its modalModels, and the nodes referring to them. All other values of the JSON
// text keep their value and their number, the bytes of its buffers theirs, and further chunks of a .glb stay. A .glb
// with a buffer inside, or without any, takes the models' arrays in its binary chunk; for any other file they go into a
// new buffer, a file named `stem` and by its content. `name` stands in errors. Fails on what parse_gltf() refuses, and
// when the JSON text would become larger than a reader takes.
Result<ExtendedGltf> add_models(std::string_view file, const std::string& name, const std::string& stem,
                                std::span<const AddedModel> models);

}  // namespace ringdown::modal
