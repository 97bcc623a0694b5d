// Thermoelastic loss of a body's modes: prepares the ratios of its parts for the finite elements (fem/heat_flow.h), and
// converts their results to the body's own size and material. [worker]
#pragma once

#include "engine/bake/body_modes.h"
#include "engine/fem/heat_flow.h"
#include "engine/modal/bank.h"
#include "engine/modal/losses.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace ringdown::bake {

struct BodyHeat {
  std::optional<modal::Material> reference;  // the first material that says how it warms; absent: no heat flows
  std::vector<fem::HeatRatios> parts;        // by part, over the reference; a part that does not say how it warms
                                             // neither warms nor conducts

  BodyHeat() = default;  // no heat flows
  // `materials` are those of the body's parts, in their order.
  explicit BodyHeat(const std::vector<modal::Material>& materials);

  // The relaxations of mode `m` of those that `pairs` has (BodyModes::heat), with the time in seconds; all 0 where no
  // heat flows.
  [[nodiscard]] modal::ModeHeat relaxations(const Eigen::MatrixXd& pairs, const BodyUnits& units, Eigen::Index m) const;
};

}  // namespace ringdown::bake
