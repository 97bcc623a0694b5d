#include "engine/gltf/gltf_file.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/silent.h"
#include "engine/scene/world.h"
#include "tests/fuzz/targets.h"

#include <cmath>
#include <string>

namespace ringdown::fuzz {
namespace {

// A file beside the scene: so many zeros.
Result<std::string> beside(const std::string& name, std::size_t limit) {
  if (name.empty() || limit < 4096) return fail(ErrorKind::bad_input, "no such file");
  return std::string(4096, '\0');
}

// What was accepted can be played: bodies move, and stay where they are finite.
void play(const scene::SceneDescription& description) {
  constexpr int kSteps = 3;
  auto world = scene::World::create(description, {}, 48000);
  if (!world) return expect(!world.error().message.empty(), "a world is refused with a sentence");
  for (int k = 0; k < kSteps; ++k) world->step();
  for (const scene::BodyState& body : world->bodies()) expect(std::isfinite(body.position_m.x), "bodies stay finite");
}

}  // namespace

void gltf(Bytes file) {
  const auto read = scene::parse_gltf_scene(file, "room.gltf", beside);
  if (!read) return expect(!read.error().message.empty(), "a refusal has a sentence");
  for (const std::string& note : read->notes) expect(!note.empty(), "a note has a sentence");
  const auto document = modal::parse_gltf(file, "room.gltf", beside);
  expect(document.has_value(), "what is a scene is a document");
  const auto silent = scene::find_silent_bodies(*document);
  expect(silent || !silent.error().message.empty(), "a refusal has a sentence");
  if (silent) {
    for (const scene::SilentBody& body : silent->bodies) {
      const bool has_geometry = !body.surface.triangles.empty() || !body.geo.empty();
      expect(has_geometry || !body.trouble.empty(), "a silent body has a geometry, or a reason");
      for (const Vec3& p : body.surface.points_m) expect(std::isfinite(length(p)), "points are finite");
    }
  }
  constexpr std::size_t kMaxBodies = 64;  // of which a few steps take no time
  if (read->scene.bodies.size() <= kMaxBodies) {
    scene::SceneDescription quiet = read->scene;
    quiet.objects.clear();
    for (scene::BodyDescription& body : quiet.bodies) body.object.clear();
    play(quiet);
  }
}

}  // namespace ringdown::fuzz
