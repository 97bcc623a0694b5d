// The tubes under a bar, as [[resonator]] of an object file says. [any thread]
//
//   [[resonator]]
//   diameter_m = 0.04            # of the tube, inside; lengths are before `scale`
//   mouth_m = [0, 0, -0.0075]    # the middle of its mouth
//   axis = [0, 0, -1]            # points into the tube; default
//   tuned_to = 1                 # a mode by its number from the lowest one, up to 19; or Hz from 20 on; or a note
//   detune_cents = -10           # default 0
//   length_m = 0.372             # in place of tuned_to
//   stopped = true               # at its far end; default. false: open there
#pragma once

#include "engine/base/toml_table.h"
#include "engine/base/vec3.h"

#include <optional>
#include <vector>

namespace ringdown::bake {

struct Resonator {
  double radius_m = 0;
  Vec3 mouth_m, axis{0, 0, -1};
  int tuned_mode = 1;              // counted from 1; used if the others are absent
  std::optional<double> tuned_hz;  // in place of a mode
  std::optional<double> length_m;  // in place of both
  double detune_cents = 0;
  bool stopped = true;

  // Returns the same tube under a body of `scale` times the size.
  [[nodiscard]] Resonator scaled(double scale) const;
};

inline constexpr std::size_t kMaxResonators = 16;  // of an object

// Errors are noted in the file.
void read_resonators(TomlTable& file, std::vector<Resonator>& resonators);

}  // namespace ringdown::bake
