// The modes of an object as the table and the bars show them: in the object's material and size, excited at a node.
// [UI]
#pragma once

#include "clients/viewer/edits.h"
#include "clients/viewer/link/model.h"

#include <cstdint>
#include <vector>

namespace ringdown::viewer {

struct ListedMode {
  double frequency_hz = 0;  // 0: over-damped, without a pitch
  double t60_s = 0;
  double gain_db = 0;     // level, re full scale, at which 1 N s into the surface at the node starts the mode
  bool selected = false;  // whether the object plays the mode
};

// Returns the modes by rank. `node` is a sample point of the bank; a number past the last point means the last point.
std::vector<ListedMode> list_modes(const KnownBank& bank, const Adjustment& adjustment, std::uint32_t node);

// Returns the unit direction out of the surface at a sample point: the mean of its triangles' normals, or up if there
// are none.
Vec3 outward_normal(const modal::Bank& bank, std::uint32_t point);

}  // namespace ringdown::viewer
