// The pressure of a layer of sources at the surface itself. [worker]
#pragma once

#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace ringdown::radiate {

// P just outside of the middle of a triangle of the part, for layers (V x M) of one class: mu/2 + D mu - i S (eta mu).
// `images` are the part and its mirror images in their order (panels.h); without mirror planes the part alone. Of
// near triangles the static part of the integrals is exact; what the wave adds is smooth, and is summed over the
// middles of sides, as is all of farther ones.
Eigen::RowVectorXcd pressure_at(std::span<const Panels> images, int image_class, int triangle, double wavenumber_rad_m,
                                const std::vector<double>& coupling, const Eigen::MatrixXcd& layers);

}  // namespace ringdown::radiate
