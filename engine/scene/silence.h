// Why a scene, or a body of it, is not heard: sentences for its user. [any thread]
#pragma once

#include "engine/scene/body_store.h"
#include "engine/scene/description.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxNamed = 8;  // bodies that are named one by one; of more, their number is given

// The bodies that play an object whose modes all lie above hearing, a sentence for each. Of them only the click of
// their blows is heard.
std::vector<std::string> above_hearing(const SceneDescription& scene, std::span<const SoundingObject> objects);

// Why nothing in the scene can ever sound, as long as nobody adds to it; nothing where something can, or where the
// scene only has objects for requests to play. `cure` says what gives a body its sound.
std::optional<std::string> why_silent(const SceneDescription& scene, std::span<const SoundingObject> objects,
                                      const std::string& cure);

}  // namespace ringdown::scene
