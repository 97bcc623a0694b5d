// The font that people here read by: what fontconfig gives for sans. [main]
#pragma once

#include <optional>
#include <string>

namespace ringdown::viewer {

// A TrueType file; nothing where there is none, and ImGui's own must do.
std::optional<std::string> sans_font_file();

}  // namespace ringdown::viewer
