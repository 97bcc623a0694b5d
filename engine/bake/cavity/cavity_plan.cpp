#include "engine/bake/cavity/cavity.h"
#include "engine/base/range.h"

#include <cstdint>

namespace ringdown::bake {

CavityPlan CavityPlan::scaled(double scale) const { return {scale * mouth_m, scale * diameter_m, modes}; }

std::optional<CavityPlan> read_cavity(TomlTable& file) {
  constexpr Range kMouth_m{-1e6, 1e6}, kDiameter_m{1e-6, 1e3};
  constexpr std::uint64_t kMaxModes = 8;
  std::optional<TomlTable> table = file.table("cavity");
  if (!table) return std::nullopt;
  CavityPlan plan;
  table->require({"mouth_m", "diameter_m"});
  table->vector("mouth_m", plan.mouth_m, kMouth_m);
  table->number("diameter_m", plan.diameter_m, kDiameter_m);
  std::uint64_t modes = 1;
  table->whole("modes", modes, 1, kMaxModes);
  plan.modes = static_cast<int>(modes);
  return plan;
}

}  // namespace ringdown::bake
