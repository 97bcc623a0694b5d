#include "engine/bake/body_modes.h"

#include <algorithm>
#include <cmath>

namespace ringdown::bake {

double BodyUnits::shape() const { return 1 / std::sqrt(density_kg_m3 * std::pow(length_m, 3)); }

modal::MassProperties BodyUnits::mass(const modal::MassProperties& body) const {
  modal::MassProperties mass = body;
  const double unit_kg = density_kg_m3 * std::pow(length_m, 3);
  mass.mass_kg = unit_kg * body.mass_kg;
  mass.center_of_mass_m = length_m * body.center_of_mass_m;
  mass.inertia_kg_m2 = unit_kg * length_m * length_m * body.inertia_kg_m2;
  return mass;
}

BodyModes up_to(BodyModes modes, double top) {
  const auto count = std::upper_bound(modes.lambda.begin(), modes.lambda.end(), top) - modes.lambda.begin();
  modes.lambda.conservativeResize(count);
  modes.residuals.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
  if (modes.errors.size() > 0) modes.errors.conservativeResize(count);
  modes.complete_to = std::min(modes.complete_to, top);
  return modes;
}

double characteristic_length(const mesh::Points& nodes) {
  return (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).norm();
}

}  // namespace ringdown::bake
