// The air in a body as a bank has it: modes of its own, beside those of the body. [any thread]
//
// The walls do not feel these modes: their shapes are 0 at every sample point. A pressure in the mouth drives them
// (synth/events/verbs.h: Slap, Blow). docs/how/cavities.md has the equations.
#pragma once

#include "engine/base/vec3.h"

#include <cstdint>
#include <numbers>
#include <vector>

namespace ringdown::modal {

struct Cavity {
  struct Mode {
    std::uint32_t mode = 0;  // of the bank
    double flux = 0;         // volume out of the mouth for a coordinate of 1 [m^2 kg^-1/2]
  };
  Vec3 mouth_m;           // the middle of the mouth, in the object's frame
  double diameter_m = 0;  // of the mouth
  std::vector<Mode> modes;

  [[nodiscard]] double mouth_area_m2() const { return std::numbers::pi / 4 * diameter_m * diameter_m; }
};

}  // namespace ringdown::modal
