// The viewer: the model of a daemon, three panes, keys and settings, frame by frame. [main]
//
//   App app(std::move(window), std::move(renderer), settings, {...});
//   while (app.runs()) app.frame();
#pragma once

#include "clients/viewer/camera_listener.h"
#include "clients/viewer/commands.h"
#include "clients/viewer/keys.h"
#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/panels/drop_panel.h"
#include "clients/viewer/panels/scene_view.h"
#include "clients/viewer/panels/side_view.h"
#include "clients/viewer/panels/sound_view.h"
#include "clients/viewer/settings.h"
#include "clients/viewer/window.h"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace ringdown::viewer {

class App {
 public:
  static constexpr double kNotices_hz = 60;

  struct Options {
    std::string daemon;                // URL of the daemon
    std::optional<std::string> scene;  // loaded once, when a daemon answers
    Pane only = Pane::any;             // if not `any`: shows only the scene pane or the sound pane
    std::optional<double> shown_at_s;  // scene time to show; nothing: the current time
  };
  App(Window window, SceneRenderer renderer, const Settings& settings, Options options);
  App(const App&) = delete;  // its parts refer to each other by address
  App& operator=(const App&) = delete;

  // Returns false once the user has quit.
  [[nodiscard]] bool runs() const { return runs_ && !window_.closed(); }

  // Waits until the next frame is due, and draws it.
  void frame();
  // Processes replies from the daemon and input from the user, and draws a frame at once.
  void draw();

  [[nodiscard]] Model& model() { return model_; }
  [[nodiscard]] Commands& commands() { return commands_; }
  [[nodiscard]] DaemonClient& client() { return client_; }
  [[nodiscard]] const DaemonClient& client() const { return client_; }
  [[nodiscard]] const Window& window() const { return window_; }
  [[nodiscard]] const SceneView& scene_view() const { return scene_; }
  [[nodiscard]] const MeshBaker& baker() const { return drops_.baker(); }
  [[nodiscard]] Pane focused() const { return focused_; }
  void show_at(std::optional<double> scene_time_s) { options_.shown_at_s = scene_time_s; }

  // The settings to save.
  [[nodiscard]] Settings settings() const;

 private:
  using Clock = std::chrono::steady_clock;

  void talk();
  void handle_keys(double seconds);
  void perform(Action action);
  void draw_panes();
  void take(const std::filesystem::path& dropped);
  template <class Draw>
  void pane(const char* name, Pane which, float x, float width, Draw draw);
  [[nodiscard]] double now_s() const;

  Window window_;
  Settings settings_;
  Options options_;
  Skin skin_;
  DaemonClient client_;
  Model model_;
  Commands commands_;
  SceneView scene_;
  DetailControl detail_;
  CameraListener listener_;
  SoundView sound_;
  SideView side_;
  DropPanel drops_;  // bakes by the ringdown-bake beside this program
  Pane focused_ = Pane::scene;
  std::optional<Pane> focus_next_;
  std::uint32_t connection_ = 0;
  bool runs_ = true, help_ = false;
  bool popup_ = false;  // whether a list, such as that of materials, was open in the last frame
  Clock::time_point start_ = Clock::now(), last_frame_ = Clock::now();
  double skinned_scale_ = 0;
};

}  // namespace ringdown::viewer
