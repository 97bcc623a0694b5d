// Explains to the user why a scene, or a body of it, is not heard. [any thread]
#pragma once

#include "engine/scene/body_store.h"
#include "engine/scene/description.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxNamed = 8;  // maximum number of bodies listed by name; beyond it only their number is
                                             // given

// Returns one sentence for each body that plays an object whose modes all lie above hearing. Only the click of a strike
// on such a body is heard.
std::vector<std::string> above_hearing(const SceneDescription& scene, std::span<const SoundingObject> objects);

// Returns why nothing in the scene can ever sound unless something is added. Returns nothing if something can sound, or
// if the scene only has objects for requests to play. `cure` says how to give a body a sound.
std::optional<std::string> why_silent(const SceneDescription& scene, std::span<const SoundingObject> objects,
                                      const std::string& cure);

}  // namespace ringdown::scene
