// Writes a picture of a scene at a given time as a PNG file, without showing a window. [main]
#pragma once

#include "clients/viewer/keys.h"
#include "clients/viewer/settings.h"
#include "engine/base/result.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace ringdown::viewer {

struct ScreenshotRequest {
  std::filesystem::path output;       // .png
  std::filesystem::path scene;        // a path that the daemon can read
  double at_s = 1;                    // scene time
  std::optional<std::string> daemon;  // URL of the daemon; nothing: starts one, which ends afterwards
  Pane only = Pane::any;
  std::function<bool()> keep_going = [] { return true; };  // false cancels
};

// Plays the scene from its beginning to `at_s` in real time, and draws the bodies at that time. Fails if the daemon
// refuses the scene, or is more than a minute late.
Result<void> take_screenshot(const ScreenshotRequest& request, const Settings& settings);

}  // namespace ringdown::viewer
