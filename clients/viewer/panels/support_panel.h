// The faces chosen as a support, marked on the surface and as text for an object file. [UI]
#pragma once

#include "clients/viewer/panels/skin.h"
#include "clients/viewer/support_choice.h"

#include <array>
#include <functional>
#include <optional>

namespace ringdown::viewer {

// A triangle that is counter-clockwise from outside, where its corners are in the window, whose y points down.
bool faces_camera(const std::array<ImVec2, 3>& corners);

// Marks the chosen triangles that face the camera. `place` gives a point of the object's frame in the window, or
// nothing where it is not seen.
void mark_support(const Skin& skin, const SupportChoice& choice,
                  const std::function<std::optional<ImVec2>(Vec3)>& place);

// A panel at the lower right of the picture, while anything is chosen: kind, text, and buttons that copy it (to the
// clipboard and standard output) or give the choice up.
void draw_support(const Skin& skin, ImVec2 origin, ImVec2 size, SupportChoice& choice);

// Copies the text to the clipboard and prints it.
void copy_support(const SupportChoice& choice);

}  // namespace ringdown::viewer
