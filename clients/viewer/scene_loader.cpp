#include "clients/viewer/scene_loader.h"

#include <algorithm>

namespace ringdown::viewer {

void SceneLoader::load(const std::string& path) {
  waiting_ = {path, model_.scene().version(), model_.message_count()};
  send_(protocol::SceneLoad{path, true});
}

// Messages may get lost, so the scene is told to begin again and again until it runs.
void SceneLoader::update(double now_s) {
  constexpr double kAgain_s = 0.5;
  read_answer();
  if (!waiting_) return;
  const KnownScene& scene = model_.scene();
  const bool is_loaded = waiting_->is_loaded || scene.description().file == waiting_->path;
  if (!is_loaded || scene.version() == waiting_->version_before || !scene.up_to_date()) return;
  if (!scene.paused()) return stop_waiting();
  if (!model_.has_whole_scene()) return;
  if (waiting_->told_at_s && now_s - *waiting_->told_at_s < kAgain_s) return;
  waiting_->told_at_s = now_s;
  send_(protocol::ScenePause{false});
}

// If the daemon has refused to load the scene, there is nothing to wait for.
void SceneLoader::read_answer() {
  if (!waiting_) return;
  const auto answer = std::ranges::find_if(model_.messages(), [this](const KnownMessage& message) {
    return message.order >= waiting_->messages_before && message.address == "/scene/load";
  });
  if (answer == model_.messages().end()) return;
  waiting_->is_loaded = true;
  if (answer->failed) stop_waiting();
}

}  // namespace ringdown::viewer
