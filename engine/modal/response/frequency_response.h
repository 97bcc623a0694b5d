// Frequency responses of a bank: its motion, or the sound pressure, per newton of a force at one place. [any]
//
// With time as exp(+i omega t), a force of 1 N along d at a, the motion along e at b is
//
//   H(omega) = sum over modes of (phi(b).e) (phi(a).d) / (lambda - omega^2 + 2 i omega delta)
//            + rigid motion of a free body, from its mass and inertia
//            + the residual of the modes that the bank leaves out, if it is known (residual.h)
//
// with lambda and decay delta of each mode. Shapes between sample points are interpolated as in a strike. H is the
// receptance [m/N]; i omega H is the mobility, and -omega^2 H the accelerance. Exchanging the two places changes H only
// by rounding.
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/response/residual.h"
#include "engine/modal/surface_index.h"

#include <complex>
#include <span>
#include <vector>

namespace ringdown::modal {

enum class Motion { displacement, velocity, acceleration };  // receptance, mobility, accelerance

// A place of the surface, the nearest to `point_m`, and a direction of any length but 0.
struct Place {
  Vec3 point_m, direction;
};

using Response = std::vector<std::complex<double>>;

// Returns the motion at `to` per newton at `from`, for each frequency, which must be above 0 [m/N, m/(N s), 1/kg].
// `surface` is the bank's; `residual` may be null. Costs O(modes) for each frequency. Fails when a place lies farther
// off the body than the body is large, a direction has no length, or a frequency is not above 0.
Result<Response> frequency_response(const Bank& bank, const SurfaceIndex& surface, const Place& from, const Place& to,
                                    Motion motion, std::span<const double> frequencies_hz,
                                    const Residual* residual = nullptr);

// Returns the sound pressure at a point in the air per newton at `from` [Pa/N]: the sum of the modes' far fields, each
// with the directions that it has at the mode's own frequency, and with 1/r from the origin of the radiation maps.
// Rigid motion and residual are not heard. Fails as frequency_response() does, without radiation maps, and for a point
// that lies in the sphere around the body.
Result<Response> pressure_response(const Bank& bank, const SurfaceIndex& surface, const Place& from, Vec3 to_m,
                                   std::span<const double> frequencies_hz);

// Returns the mean power that the bank radiates at each frequency per squared newton of force amplitude [W/N^2]. Modes
// add up with their phases over all directions.
Result<std::vector<double>> power_response(const Bank& bank, const SurfaceIndex& surface, const Place& from,
                                           std::span<const double> frequencies_hz);

// Returns the energy that the bank radiates per hertz after an impulse of 1 N s at `from`, at each frequency
// [J / Hz / (N s)^2].
Result<std::vector<double>> energy_spectrum(const Bank& bank, const SurfaceIndex& surface, const Place& from,
                                            std::span<const double> frequencies_hz);

}  // namespace ringdown::modal
