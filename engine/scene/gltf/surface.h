// Reads acoustic surfaces of a glTF scene (KHR_audio_rigid_bodies). [worker]
#pragma once

#include "engine/modal/surface_relief.h"
#include "engine/scene/description.h"

#include <memory>
#include <optional>
#include <vector>

namespace ringdown::modal {
class JsonPlace;
}

namespace ringdown::scene {

class GltfDocument;

// Reads the friction and the restitution of a `physicsMaterials` element. Missing values take the draft's defaults.
void read_friction(GltfDocument& document, const modal::JsonPlace& material, FrictionSurface& surface);

// Reads the finish and the waviness of an `acousticSurfaces` element. Missing values, or a missing element, take the
// draft's defaults.
void read_finish(GltfDocument& document, const modal::JsonPlace& finish, FrictionSurface& surface);

// Reads the measured track of an `acousticSurfaces` element, if there is one.
std::optional<modal::SurfaceTrack> read_profile(GltfDocument& document, const modal::JsonPlace& finish);

// Keeps the reliefs of scenes that were played, because a mixer may use a relief that an event points to
// (synth::Passing) after the scene has ended. Equal reliefs are kept once.
class Reliefs {
 public:
  static constexpr std::size_t kMax = 1024;

  // Replaces reliefs in the scene by equal ones kept before, and keeps the rest. Fails if there are more than kMax.
  Result<void> keep(SceneDescription& scene);

 private:
  std::vector<std::shared_ptr<const modal::SurfaceRelief>> kept_;
};

}  // namespace ringdown::scene
