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
  Vec3 direction;                 // of the blow, a unit vector into the surface
  std::vector<double> amplitude;  // of each mode, for 1 N s, without contact time: 2 pi f (phi . direction)
};

// At the sample point nearest to `at`, or at the one that answers with most energy. Along the surface's normal; where
// there are no triangles, along whichever axis answers most.
Answer answer_of(const modal::Bank& bank, std::optional<Vec3> at);

// Level of the sound's spectrum at a frequency [dB re an arbitrary unit]: the modes' resonances, summed with their
// phases.
double level_db(const modal::Bank& bank, const Answer& answer, double frequency_hz);

// Unit normals of the sample points; (0, 0, 0) where no triangle is.
std::vector<Vec3> normals_of(const modal::Bank& bank);

inline Vec3 wide(const modal::Vec3f& v) { return {v[0], v[1], v[2]}; }

}  // namespace ringdown::cli
