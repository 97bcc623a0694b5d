// The windows' font: the desktop's "sans" as fontconfig names it, or ImGui's own where there is none. [UI]
#pragma once

namespace ringdown::viewer {

// Puts the font, for a scale of text and controls, into the atlas of ImGui's present context in place of what it holds.
// The caller uploads the atlas. A stretched font would be blurred, so call this again for another scale.
void load_font(double scale);

}  // namespace ringdown::viewer
