// The camera and the listener by numbers: a section of the left pane. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/render/camera.h"

namespace ringdown::viewer {

// Draws the section. `listens` is whether the daemon hears its objects from the camera; otherwise the listener is where
// the section's numbers say, or nowhere.
void draw_view(Camera& camera, Commands& commands, bool& listens);

}  // namespace ringdown::viewer
