// How far a strike anywhere on a body is from what its finite elements say.
//
// The truth for mode m at a point x of the meshed surface is phi_m(x), interpolated by the element's own shape
// functions (curved_skin.h). The engine's answer is what modal::StrikeMap::excite() gives mode m for unit impulses
// along the outward normal there and along two tangents. With all points and directions together,
//
//   error_m = rms(engine - truth) / rms(truth).
//
// The truth is the solution that the bank was made from, read from the cache of modes, because another solve may turn a
// family of equal frequencies (a sphere's, a square plate's, a tube's) into another basis of the same motions.
#pragma once

#include "engine/base/result.h"
#include "engine/bake/bake.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/modal/bank.h"
#include "tests/bake/curved_skin.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace ringdown::test {

// A body as finite elements have solved it.
struct Solution {
  mesh::TetMesh mesh;            // of the element's order [m]
  Eigen::VectorXd frequency_hz;  // m, damped, of the elastic modes; 0 for one without pitch
  Eigen::MatrixXd shapes;        // 3S x m [kg^-1/2], at CurvedSkin::nodes()
};

// The modes that a bake() of this mesh, material and options has left in the cache, options.cache. Fails when they are
// not there.
Result<Solution> kept_solution(const mesh::TetMesh& mesh, const modal::Material& material,
                               const bake::BakeOptions& options);

struct AmplitudeErrors {
  std::vector<double> by_mode;  // error_m in the bank's order
  double median = 0;            // of by_mode
  double largest = 0;           // of by_mode
  // The surface is divided into 32 regions of equal area (the two sides of a wall are different regions). A region's
  // error of a mode is rms(engine - truth) inside it over the mode's rms(truth) on the whole surface; of all modes the
  // rms is taken, and the median.
  double worst_region = 0;               // the largest rms of any region
  double worst_region_median = 0;        // the largest median of any region
  Eigen::Vector3d worst_place{0, 0, 0};  // the mean of that region's points [m]
};

struct AmplitudeSampling {
  std::size_t points = 2000;  // of each seed
  int seeds = 5;
};

// A mode of a bank may be any of the solution whose frequency is the same to this share: a bank's file keeps
// frequencies as 32-bit floats, and a solver with other threads finds others in the seventh digit. Among several the
// one with the larger inner product is taken.
inline constexpr double kSameFrequency = 1e-6;

// Fails when a mode of the bank is not in the solution. The sign of a mode is the bank's choice: here it is the one
// that makes the inner product with the truth positive.
Result<AmplitudeErrors> amplitude_errors(const modal::Bank& bank, const Solution& solution,
                                         const AmplitudeSampling& sampling = {});

}  // namespace ringdown::test
