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

// A model, and the nodes that play it.
struct AddedModel {
  const Bank* bank = nullptr;  // the points are in the nodes' own frames
  std::vector<std::size_t> nodes;
  std::optional<std::size_t> material;  // the number of an acoustic material of the file
};

struct ExtendedGltf {
  std::string file;                 // the new bytes of the .glb or .gltf
  std::string buffer_name, buffer;  // name and bytes of a file beside it, to be written first; empty: none
};

// Returns `file` with the models appended to its modalModels and the nodes referring to them. All other JSON values
// keep their content and their index; the bytes of the buffers and further chunks of a .glb stay as they are. If the
// file is a .glb whose buffer is inside, or that has no buffer, the models' arrays go into the binary chunk; otherwise
// they go into a new buffer file, named after `stem` and its content. `name` replaces the path in errors. Fails on what
// parse_gltf() refuses, and when the JSON text would become larger than a reader accepts.
Result<ExtendedGltf> add_models(std::string_view file, const std::string& name, const std::string& stem,
                                std::span<const AddedModel> models);

}  // namespace ringdown::modal
