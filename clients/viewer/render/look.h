// The colours of bodies, and the colours and light of the two themes. [any]
#pragma once

#include "clients/viewer/render/scene_frame.h"
#include "clients/viewer/render/shaders.h"

#include <string_view>

namespace ringdown::viewer {

// Returns the colour of a body made of the named material: sRGB as in style sheets, each component 0 ... 1. Colours are
// Okabe and Ito's ("Color Universal Design", 2008), which are distinguishable with any colour vision, and tints between
// them. Bronze, brass, copper and gold are orange to vermilion, steels and other white metals blue to sky blue, glass
// and ice sky blue, woods yellow-brown, stone and ceramics bluish green, plastics reddish purple. Any other name gets
// one of the palette's colours by a hash of the name, equal on every machine.
glm::vec3 material_colour(std::string_view name);

inline constexpr glm::vec3 kSilentColour{0.62F, 0.62F, 0.62F};  // colour of silent bodies
glm::vec3 static_colour(Theme theme);                           // colour of static boxes, sRGB
glm::vec3 linear_from_srgb(glm::vec3 srgb);

// Returns the uniform block of a frame. `aspect` is width over height.
FrameBlock frame_block(const SceneFrame& frame, const Camera& camera, float aspect);

// Returns the distance between the fine lines of the ground's grid: a power of ten between 1/20 and 1/2 of the radius.
// [m]
float grid_spacing(float radius_m);

}  // namespace ringdown::viewer
