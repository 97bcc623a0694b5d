// A scene that is simulated, the keyframes of its bodies, and a comparison of its contacts with those recovered from
// the keyframes.
#pragma once

#include "engine/scene/contact/heard_contact.h"
#include "engine/scene/world.h"

#include <cstddef>
#include <string>
#include <vector>

namespace ringdown::test {

// The contacts of a scene and, if it was simulated, the scene of animated bodies with the same motion.
struct Played {
  std::vector<scene::HeardContact> contacts;
  scene::SceneDescription animated;
};

// Simulates a scene and records its bodies at `fps`.
Played simulate(const scene::SceneDescription& scene, const std::vector<scene::SoundingObject>& objects, double fps);

// Plays a scene of animated bodies.
std::vector<scene::HeardContact> play(const scene::SceneDescription& animated,
                                      const std::vector<scene::SoundingObject>& objects);

struct Comparison {
  std::size_t alone = 0, found = 0, false_ones = 0;  // blows that lie apart from the pair's others; of them found
  double time_ms = 0, worst_ms = 0;                  // error of time: 90th percentile, largest
  double impulse_db = 0;                             // median of the error's size
  std::size_t groups = 0;
  double group_db = 0;  // of the summed impulses of dense blows: median of the error's size
};
Comparison compare(const std::vector<scene::HeardContact>& truth, const std::vector<scene::HeardContact>& recovered,
                   double fps, bool verbose = false);

}  // namespace ringdown::test
