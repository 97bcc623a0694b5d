// The response of a bank to a blow at one of its sample points. [any]
#pragma once

#include "engine/base/vec3.h"
#include "engine/modal/bank.h"

#include <optional>
#include <span>
#include <vector>

namespace ringdown::cli {

struct Answer {
  std::size_t point = 0;
  Vec3 direction;                 // direction of the blow, a unit vector into the surface
  std::vector<double> amplitude;  // amplitude of each mode for 1 N s, without contact time: 2 pi f (phi . direction)
};

// Computes the response at the sample point nearest to `at`, or at the one that responds with the most energy. The blow
// is along the surface's normal, or, without triangles, along the axis with the strongest response.
Answer answer_of(const modal::Bank& bank, std::optional<Vec3> at);

// Returns the level of the sound's spectrum at a frequency [dB re an arbitrary unit]: the modes' resonances, summed
// with their phases.
double level_db(const modal::Bank& bank, const Answer& answer, double frequency_hz);

// Returns the unit normals of the sample points; (0, 0, 0) for points without a triangle.
std::vector<Vec3> normals_of(const modal::Bank& bank);

inline Vec3 wide(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

}  // namespace ringdown::cli
