// The settings that the viewer keeps from one run to the next: $XDG_CONFIG_HOME/ringdown/viewer.toml, or
// ~/.config/ringdown/viewer.toml. [UI]
#pragma once

#include "engine/base/result.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace ringdown::viewer {

struct Settings {
  static constexpr std::uint64_t kMinWidth = 320, kMinHeight = 240, kMaxPixels = 16384;
  std::string daemon;  // URL of the daemon; empty: the default
  bool dark = true;
  double scale = 0;                              // scale of text and controls; 0: the display's scale
  std::uint64_t width = 1440, height = 900;      // pixels on a display of scale 1
  double side_share = 0.23, sound_share = 0.28;  // widths of the side and sound panes, as shares of the window
  double impulse_ns = 0.05;                      // impulse of the test force and of a click
  double contact_time_s = 0.0005;
  bool listen = true;            // whether to listen from the camera
  bool strength_by_time = true;  // a click strikes harder the longer the button is held
};

// Returns the path of the settings file. Fails without a home folder.
Result<std::filesystem::path> settings_file();

// Reads the settings; returns the defaults if there is no such file. Fails on a malformed file, with path and line.
Result<Settings> read_settings(const std::filesystem::path& file);

// Writes the settings atomically, and makes the folder if it is missing.
Result<void> write_settings(const Settings& settings, const std::filesystem::path& file);

}  // namespace ringdown::viewer
