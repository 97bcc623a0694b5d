// One picture of a scene at a moment, as a PNG file, without anybody looking. [main]
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
  std::filesystem::path scene;        // as the daemon finds it
  double at_s = 1;                    // scene time
  std::optional<std::string> daemon;  // its URL; nothing: one of our own, which ends afterwards
  Pane only = Pane::any;
  std::function<bool()> keep_going = [] { return true; };  // false cancels
};

// Plays the scene from its beginning until that moment, in real time, and draws the bodies where they are then. Fails
// when the daemon refuses the scene, or does not get that far within a minute more than it should take.
Result<void> take_screenshot(const ScreenshotRequest& request, const Settings& settings);

}  // namespace ringdown::viewer
