// The settings that the viewer keeps from one run to the next: $XDG_CONFIG_HOME/ringdown/viewer.toml, else
// ~/.config/ringdown/viewer.toml. [UI]
#pragma once

#include "engine/base/result.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace ringdown::viewer {

struct Settings {
  static constexpr std::uint64_t kMinWidth = 320, kMinHeight = 240, kMaxPixels = 16384;
  std::string daemon;  // its URL; empty: the default one
  bool dark = true;
  double scale = 0;                              // of text and controls; 0: the display's scale
  std::uint64_t width = 1440, height = 900;      // pixels on a display of scale 1
  double side_share = 0.23, sound_share = 0.28;  // of the width: the panes to the left and right of the scene
  double impulse_ns = 0.05;                      // of the test force, and of a click
  double contact_time_s = 0.0005;
  bool listen = true;            // from where the camera is
  bool strength_by_time = true;  // a click strikes harder the longer the button is held
};

// The path of the settings file. Fails without a home folder.
Result<std::filesystem::path> settings_file();

// Reads the settings; the defaults if there is no such file. Fails on a malformed file, with path and line.
Result<Settings> read_settings(const std::filesystem::path& file);

// Writes the settings atomically, and makes the folder if it is missing.
Result<void> write_settings(const Settings& settings, const std::filesystem::path& file);

}  // namespace ringdown::viewer
