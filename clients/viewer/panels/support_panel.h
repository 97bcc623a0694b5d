// The faces chosen as a support, marked on the surface and as text for an object file. [UI]
#pragma once

#include "clients/viewer/panels/skin.h"
#include "clients/viewer/support_choice.h"

#include <array>
#include <functional>
#include <optional>

namespace ringdown::viewer {

// Returns whether a triangle faces the camera, from its corners in the window, whose y points down: triangles are
// counter-clockwise from outside.
bool faces_camera(const std::array<ImVec2, 3>& corners);

// Marks the chosen triangles that face the camera. `place` returns the window position of a point in the object's
// frame, or nothing if it is not visible.
void mark_support(const Skin& skin, const SupportChoice& choice,
                  const std::function<std::optional<ImVec2>(Vec3)>& place);

// While anything is chosen, draws a panel at the lower right of the picture: kind, text, and buttons that copy the text
// (to the clipboard and standard output) or drop the choice.
void draw_support(const Skin& skin, ImVec2 origin, ImVec2 size, SupportChoice& choice);

// Copies the text to the clipboard and prints it.
void copy_support(const SupportChoice& choice);

}  // namespace ringdown::viewer
