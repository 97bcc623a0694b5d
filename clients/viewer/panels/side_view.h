// The pane at the left: the daemon, recording, saving and undo, files to load, objects, the sliders of the chosen
// object, the test force, camera and listener, and messages. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/panels/material_picker.h"
#include "clients/viewer/panels/save_panel.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/render/camera.h"
#include "clients/viewer/settings.h"

#include <array>
#include <string>

namespace ringdown::viewer {

class SideView {
 public:
  explicit SideView(const std::string& url) { set_url(url); }

  // Returns the URL of the daemon to connect to, when the user entered one; otherwise an empty string.
  std::string draw(const Skin& skin, const ConnectionState& state, Model& model, Commands& commands, Settings& settings,
                   Camera& camera);

 private:
  void set_url(const std::string& url);
  std::string draw_daemon(const Skin& skin, const ConnectionState& state);
  void draw_browser(Model& model, Commands& commands);
  void draw_sliders(const KnownObject& object, Commands& commands);
  static void draw_strike(Commands& commands, Settings& settings);
  static void draw_session(const Skin& skin, const Model& model, Commands& commands);
  static void draw_messages(const Skin& skin, const Model& model);

  std::array<char, 128> url_{}, filter_{};
  // The list of files takes the height that the rest of the pane leaves; both heights are those of the last frame.
  float files_height_ = 0, others_height_ = 1e9f;
  SavePanel save_;
  MaterialPicker materials_;
};

}  // namespace ringdown::viewer
