// Scenes of libringdown-scene: a ScenePlayer on the rack of a mixer that libringdown made. Both libraries hold objects
// of one build, so that one may use what the other made; versions that differ are refused.
#include "clients/library/ringdown_scene.h"

#include "clients/library/handles.h"
#include "engine/base/quote.h"
#include "engine/base/version.h"
#include "protocol/request.h"
#include "server/session/scene_player.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

using namespace ringdown;
using library::guarded, library::missing;

struct ringdown_scene {
  explicit ringdown_scene(ringdown_mixer* its_mixer)
      : mixer(its_mixer), player(its_mixer->rack, its_mixer->banks, its_mixer->roots) {}
  ringdown_mixer* mixer;
  session::ScenePlayer player;
};

namespace {

// ODE keeps global state: one call after the other, in the whole process.
std::mutex& ode() {
  static std::mutex mutex;
  return mutex;
}

template <class Work>
ringdown_result on_scene(ringdown_scene* scene, ringdown_error* error, Work work) {
  return guarded(error, [&]() -> Result<void> {
    if (!scene) return missing("scene");
    const std::scoped_lock lock(ode());
    return work(scene->player);
  });
}

}  // namespace

ringdown_result ringdown_scene_load(ringdown_mixer* mixer, const char* path, int64_t frame, ringdown_scene** scene,
                                    ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (!path) return missing("path");
    if (!scene) return missing("scene");
    if (std::string(ringdown_version()) != kVersion) {
      return fail(ErrorKind::refused, std::string("libringdown is of version ") + ringdown_version() +
                                          " and libringdown-scene of " + kVersion + "; install one version of both");
    }
    if (mixer->has_scene) {
      return fail(ErrorKind::refused, "the mixer has a scene already; destroy it first");
    }
    const std::scoped_lock lock(ode());
    auto made = std::make_unique<ringdown_scene>(mixer);
    if (const auto loaded = made->player.load(path, frame); !loaded) return fail(loaded);
    mixer->has_scene = true;
    *scene = made.release();
    return {};
  });
}

void ringdown_scene_destroy(ringdown_scene* scene) {
  if (!scene) return;
  static_cast<void>(on_scene(scene, nullptr, [](session::ScenePlayer& player) { return player.clear(); }));
  const std::scoped_lock lock(ode());
  scene->mixer->has_scene = false;
  delete scene;
}

void ringdown_scene_advance(ringdown_scene* scene, int64_t frame) {
  static_cast<void>(on_scene(scene, nullptr, [&](session::ScenePlayer& player) -> Result<void> {
    player.advance_to(frame, std::nullopt);
    return {};
  }));
}

ringdown_result ringdown_scene_pause(ringdown_scene* scene, int paused, ringdown_error* error) {
  return on_scene(scene, error, [&](session::ScenePlayer& player) { return player.pause(paused != 0); });
}

ringdown_result ringdown_scene_push(ringdown_scene* scene, uint32_t body, const double impulse_ns[3],
                                    ringdown_error* error) {
  return on_scene(scene, error, [&](session::ScenePlayer& player) -> Result<void> {
    if (!impulse_ns) return missing("impulse_ns");
    protocol::ScenePush request{static_cast<std::int32_t>(std::min(body, 0x7fffffffu)), library::vector(impulse_ns)};
    if (auto good = library::check(request); !good) return good;
    return player.change(request);
  });
}

ringdown_result ringdown_scene_clear(ringdown_scene* scene, ringdown_error* error) {
  return on_scene(scene, error, [](session::ScenePlayer& player) { return player.clear(); });
}

ringdown_result ringdown_scene_find_object(ringdown_scene* scene, const char* name, uint32_t* object,
                                           ringdown_error* error) {
  return on_scene(scene, error, [&](session::ScenePlayer& player) -> Result<void> {
    if (!name) return missing("name");
    if (!object) return missing("object");
    const auto description = player.description();
    const auto named = [&](const auto& known) { return known.name == name; };
    if (!description || std::ranges::none_of(description->objects, named))
      return fail(ErrorKind::bad_input, "the scene has no object " + quote(name) + "; see its file for the names");
    const auto found = scene->mixer->rack.find({.name = name, .number = {}});
    if (!found) return fail(found);
    *object = (*found)->number;
    return {};
  });
}

ringdown_result ringdown_scene_find_body(ringdown_scene* scene, const char* name, uint32_t* body,
                                         ringdown_error* error) {
  return on_scene(scene, error, [&](session::ScenePlayer& player) -> Result<void> {
    if (!name) return missing("name");
    if (!body) return missing("body");
    const auto poses = player.poses();
    const auto found = std::ranges::find(poses.bodies, std::string_view(name), &scene::BodyState::name);
    if (found == poses.bodies.end())
      return fail(ErrorKind::bad_input, "the scene has no body " + quote(name) + "; see its file for the names");
    *body = found->id;
    return {};
  });
}

double ringdown_scene_duration_s(const ringdown_scene* scene) { return scene ? scene->player.duration_s() : 0; }
size_t ringdown_scene_bodies(const ringdown_scene* scene) { return scene ? scene->player.body_count() : 0; }

size_t ringdown_scene_poses(const ringdown_scene* scene, ringdown_body* bodies, size_t room) {
  if (!scene || (!bodies && room > 0)) return 0;
  std::size_t count = 0;
  static_cast<void>(guarded(nullptr, [&]() -> Result<void> {
    for (const scene::BodyState& body : scene->player.poses().bodies) {
      if (count++ >= room) continue;
      ringdown_body& place = bodies[count - 1];
      const Vec3& p = body.position_m;
      const Rotation& r = body.rotation;
      place = {static_cast<std::uint32_t>(body.id), {p.x, p.y, p.z}, {r.w, r.x, r.y, r.z}};
    }
    return {};
  }));
  return count;
}
