// The air in a body as [cavity] of an object file says, and its modes in a bank.
//
//   [cavity]
//   mouth_m = [0, 0, 0.3]        # the middle of its mouth; lengths are before `scale`
//   diameter_m = 0.0195          # of the mouth
//   modes = 1                    # the lowest of the air; default
#pragma once

#include "engine/bake/body_radiation.h"
#include "engine/base/toml_table.h"
#include "engine/modal/bank.h"

#include <optional>
#include <vector>

namespace ringdown::bake {

struct CavityPlan {
  Vec3 mouth_m;
  double diameter_m = 0;
  int modes = 1;

  // Returns the same mouth on a body of `scale` times the size.
  [[nodiscard]] CavityPlan scaled(double scale) const;
};

// Errors are noted in the file. [any thread]
std::optional<CavityPlan> read_cavity(TomlTable& file);

struct CavityMode {
  HeardMode heard;  // without a number in BodyModes
  double flux = 0;  // as in modal::Cavity
};

// Finds the modes of the air in the body in a band; their fields are measured from `origin_m`. Fails when cancelled,
// and when the air has none. Progress stage: "cavity". [worker]
Result<std::vector<CavityMode>> find_cavity(const RadiatingBody& body, const CavityPlan& plan, const modal::Air& air,
                                            const Vec3& origin_m, double band_low_hz, double band_high_hz,
                                            const Progress& progress);

// Appends the modes to a bank that radiates, with shapes of 0. [any thread]
void append_cavity(const CavityPlan& plan, const std::vector<CavityMode>& modes, modal::Bank& bank);

}  // namespace ringdown::bake
