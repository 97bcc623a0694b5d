// An object that has broken, as observers are told of it. [any]
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/synth/events/event.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

struct PieceReport {
  std::string name;
  std::optional<synth::ObjectNumber> number;  // nothing: it is no object, because it does not ring or is not loaded
  modal::MassProperties mass;                 // in the object's frame, size and material
  Vec3 velocity_m_s, spin_rad_s;              // beyond those of the object before it broke; 0 if it has not
};

struct BrokenObject {
  std::string name;
  std::size_t pattern = 0;
  std::vector<PieceReport> pieces;
};

}  // namespace ringdown::session
