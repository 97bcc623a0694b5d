// The modes of an object as the table and the bars show them. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/model.h"

#include <cstdint>
#include <vector>

namespace ringdown::viewer {

struct ListedMode {
  double frequency_hz = 0;  // in the object's material and size; 0: over-damped, without a pitch
  double t60_s = 0;
  double gain_db = 0;     // level, re full scale, at which 1 N s into the surface at the node starts the mode
  bool selected = false;  // the object has it
};

// By rank. `node` is a sample point of the bank; past the last one, the last one.
std::vector<ListedMode> list_modes(const KnownBank& bank, const Adjustment& adjustment, std::uint32_t node);

}  // namespace ringdown::viewer
