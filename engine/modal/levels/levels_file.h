// Reads and writes what a bank knows of a liquid's levels: extras.ringdown.levels (docs/reference/bank-format.md).
// Private to bank_file.cpp. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/gltf/glb.h"
#include "engine/modal/bank.h"
#include "engine/modal/levels/liquid_levels.h"

#include <functional>
#include <span>

namespace ringdown::modal {

// Reads the field of a bank that is otherwise read. Fails with a sentence when an array does not fit the bank's modes
// and points, when levels do not ascend, or when there are more columns than kMaxLevelColumns.
Result<LiquidLevels> read_levels(const Glb& glb, const JsonPlace& field, const Bank& bank);

// Returns the JSON of the field, and adds its arrays to the document. If `packed`, entries of the liquid's mass are
// rounded to 2^-16, and those of its own motions to 2^-18 of the largest one. `add_shapes` adds the shapes of the
// further columns.
Json levels_json(const LiquidLevels& levels, GlbWriter& writer, bool packed,
                 const std::function<std::size_t(std::span<const float>)>& add_shapes);

}  // namespace ringdown::modal
