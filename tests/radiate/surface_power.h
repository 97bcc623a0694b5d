// The power that leaves a vibrating surface, from the pressure on it: a check of the power in the far field. [worker]
//
// With the pressure i rho omega v u and the normal velocity v q on the surface,
//
//   power = -1/2 rho omega |v|^2 Im integral of u q dS
//
// The real part of that integral is the mass of air that moves with the surface. Where a body is small beside the wave
// or its flow cancels, the imaginary part is so small a share of the whole that the errors of u drown it: `share`
// tells.
#pragma once

#include "engine/modal/radiation_map.h"
#include "engine/radiate/body.h"
#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::radiate {

struct SurfacePower {
  double power_w = 0;  // at a modal velocity of amplitude 1 kg^1/2 m/s
  double share = 0;    // |imaginary part| over the absolute value of the integral
};

// What flows through each triangle (T x M): each sample's flow goes to the triangle nearest to it.
Eigen::MatrixXd triangle_flow(const Panels& panels, const FlowSamples& samples);

// For each layer (V x M) the power of its flow through the triangles (T x M). Every pair of triangles counts, in double
// precision, at about 100 ns each.
std::vector<SurfacePower> surface_power(const Panels& panels, double wavenumber_rad_m,
                                        const std::vector<double>& coupling, const Eigen::MatrixXcd& layers,
                                        const Eigen::MatrixXd& flow, const modal::Air& air);

}  // namespace ringdown::radiate
