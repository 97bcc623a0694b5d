// Acoustic surfaces of a glTF scene (KHR_audio_rigid_bodies) as surfaces of ours. [worker]
#pragma once

#include "engine/modal/surface_relief.h"
#include "engine/scene/description.h"

#include <memory>
#include <optional>
#include <vector>

namespace ringdown::modal {
class Field;
}

namespace ringdown::scene {

class GltfDocument;

// Reads the finish and the waviness of an `acousticSurfaces` element; what it leaves out, or an absent one, has the
// draft's default values.
void read_finish(GltfDocument& document, const modal::Field& finish, FrictionSurface& surface);

// Its measured track, if it has one.
std::optional<modal::SurfaceTrack> read_profile(GltfDocument& document, const modal::Field& finish);

// Keeps the reliefs of scenes that were played: a mixer feels those to which events pointed (synth::Passing), perhaps
// after the scene has ended. Equal ones are kept once.
class Reliefs {
 public:
  static constexpr std::size_t kMost = 1024;

  // Puts the ones kept before in place of equal ones in the scene. Fails when there are more than kMost.
  Result<void> keep(SceneDescription& scene);

 private:
  std::vector<std::shared_ptr<const modal::SurfaceRelief>> kept_;
};

}  // namespace ringdown::scene
