// Takes blows out of what the frames of an animation tell about one pair of bodies. [any thread]
#pragma once

#include "engine/base/vec3.h"

#include <cstddef>
#include <map>
#include <vector>

namespace ringdown::scene {

// The impulses of a pair's contacts around its frames, with the triangular weights of keyed_motion.h [N s].
using PushSeries = std::map<std::size_t, Vec3>;

// A blow between frame `interval` and the next one.
struct Blow {
  std::size_t interval = 0;
  double share = 0;  // of the interval
  Vec3 impulse_ns;
};

// The geometry of an interval in which a pair comes together fast enough to strike.
struct Approach {
  Vec3 normal;             // into the first body
  double stopping_ns = 0;  // the impulse along the normal that at least stops the approach
  double share = 0;        // of the interval, where the two begin to touch
};

// Removes blows from the series, in the order of time, and returns them. An interval may have a blow if it is in
// `approaches` and if the frames beside it tell of at least half of the stopping impulse. A load that lasts before or
// after the blow stays in the series. `weight_ns` is the impulse of the lighter body's weight in one interval, of which
// a load that changes is taken to be at most one and a half.
std::vector<Blow> take_blows(PushSeries& series, const std::map<std::size_t, Approach>& approaches, double weight_ns);

}  // namespace ringdown::scene
