// Writes a bank as a modal model inside a larger document. For the writers of banks and of scenes. [worker]
#pragma once

#include "engine/gltf/glb.h"
#include "engine/modal/bank.h"

#include <optional>

namespace ringdown::modal {

// The JSON of a model whose arrays are in the document's buffer.
struct WrittenModel {
  Json model;                    // without the number of its material
  Json primitive;                // a mesh primitive with the model's points and triangles
  std::optional<Json> material;  // an acoustic material
};

// Adds a bank's arrays to the document's buffer, compressed by meshopt if `packed` (Compression, bank_file.h).
WrittenModel add_model(GlbWriter& writer, const Bank& bank, bool packed);

}  // namespace ringdown::modal
