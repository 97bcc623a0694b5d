// The overlay of F1: all keys, by pane. [UI]
#pragma once

#include "clients/viewer/panels/skin.h"

namespace ringdown::viewer {

// Over everything; false when it was clicked away.
bool draw_help(const Skin& skin);

}  // namespace ringdown::viewer
