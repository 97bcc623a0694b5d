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

// Reads a preset scene and its banks.
struct Preset {
  scene::SceneDescription scene;
  std::vector<scene::SoundingObject> objects;
};
Preset preset_scene(const std::string& name);

// Plays a scene of animated bodies.
std::vector<scene::HeardContact> play(const scene::SceneDescription& animated,
                                      const std::vector<scene::SoundingObject>& objects);

struct Comparison {
  std::size_t alone = 0, found = 0, false_ones = 0;  // blows that lie apart from the pair's others; of them found
  std::size_t pushes = 0;                            // false ones where the pair's lasting contact has that impulse
  double time_ms = 0, worst_ms = 0;                  // error of time: 90th percentile, largest
  double impulse_db = 0;                             // median of the error's size
  std::size_t groups = 0;
  double group_db = 0;                   // of the summed impulses of dense blows: median of the error's size
  std::size_t ends = 0, ends_found = 0;  // of contacts that slide or roll for four frames or more; within two frames
};

// Blows are compared from two frames on, because a blow at the first frames has no motion before it. Blows below -30 dB
// of the loudest are not looked for, and found ones below -40 dB are not counted as false.
Comparison compare(const std::vector<scene::HeardContact>& truth, const std::vector<scene::HeardContact>& recovered,
                   double fps, bool verbose = false);

// One line: what was found of what, and how exactly.
std::string sentence_of(const Comparison& result);

}  // namespace ringdown::test
