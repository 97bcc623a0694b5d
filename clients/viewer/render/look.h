// Colours and light of the two themes, and what the light is fitted to. Inside this folder only. [any]
#pragma once

#include "clients/viewer/render/scene_frame.h"
#include "clients/viewer/render/shaders.h"

namespace ringdown::viewer {

glm::vec3 linear_from_srgb(glm::vec3 srgb);
glm::vec3 static_colour(Theme theme);  // sRGB; of static boxes

// All of the block but the samplers. `aspect`: width over height.
FrameBlock frame_block(const SceneFrame& frame, const Camera& camera, float aspect);

// Of the grid's fine lines: a power of ten, between 1/20 and 1/2 of the radius. [m]
float grid_spacing(float radius_m);

}  // namespace ringdown::viewer
