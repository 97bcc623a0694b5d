// Pictures of the mallets, one of which is chosen by a click: the parameter "Mallet". [UI]
#pragma once

#include "clients/plugin/window/edits.h"

namespace ringdown::plugin {

// Draws the row into ImGui's present window.
void draw_mallet_row(float width, Edits& edits);
float mallet_row_height();  // pixels, with ImGui's present font

}  // namespace ringdown::plugin
