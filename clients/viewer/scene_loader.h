// Loads a scene and lets it begin when its geometry has arrived in the window. A scene that began at once could be over
// before it is seen. [UI]
//
//   loader.load("demo.toml");
//   loader.update(now_s);  // at every frame
#pragma once

#include "clients/viewer/link/model.h"
#include "protocol/request.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::viewer {

class SceneLoader {
 public:
  using Send = std::function<void(protocol::Request)>;
  SceneLoader(const Model& model, Send send) : model_(model), send_(std::move(send)) {}

  void load(const std::string& path);
  void update(double now_s);  // call at every frame

  // Call when the user pauses or continues the scene, or when another daemon answers: leaves the scene as it is.
  void stop_waiting() { waiting_.reset(); }

 private:
  void read_answer();

  // A scene that will begin when its geometry has arrived.
  struct Waiting {
    std::string path;
    std::optional<std::int32_t> version_before;  // of the previous scene
    std::uint64_t messages_before;
    bool is_loaded = false;           // whether the daemon has said so
    std::optional<double> told_at_s;  // when the scene was last told to begin
  };
  const Model& model_;
  Send send_;
  std::optional<Waiting> waiting_;
};

}  // namespace ringdown::viewer
