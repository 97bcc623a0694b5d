// What the viewer remembers from one run to the next: $XDG_CONFIG_HOME/ringdown/viewer.toml, else
// ~/.config/ringdown/viewer.toml. [UI]
#pragma once

#include "engine/base/result.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace ringdown::viewer {

struct Settings {
  static constexpr std::uint64_t kMinWidth = 320, kMinHeight = 240, kMaxPixels = 16384;  // either way
  std::string daemon;  // its URL; empty: the default one
  bool dark = true;
  double scale = 0;                            // of text and controls; 0: the display's own
  std::uint64_t width = 1440, height = 900;    // pixels, of a display of scale 1
  double side_share = 0.2, sound_share = 0.3;  // of the width: the panes left and right of the scene
  double impulse_ns = 0.05;                    // of the test force, and of a click that is not held
  double contact_time_s = 0.0005;
  bool strength_by_time = true;  // how long the button is held says how hard a click strikes
};

// Where they are kept; fails without a home folder.
Result<std::filesystem::path> settings_file();

// The defaults where there is no such file. A file that is wrong is an error with path and line.
Result<Settings> read_settings(const std::filesystem::path& file);

// Makes its folder, and writes a temporary file that it then renames.
Result<void> write_settings(const Settings& settings, const std::filesystem::path& file);

}  // namespace ringdown::viewer
