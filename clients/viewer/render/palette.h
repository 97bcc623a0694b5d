// Colours of bodies: Okabe & Ito's eight (2008), told apart by the colour-blind, and tints of them between. [any]
#pragma once

#include <glm/vec3.hpp>

#include <string_view>

namespace ringdown::viewer {

// Of a body's surface: sRGB as written in pictures and style sheets, each 0 ... 1. The same name has the same colour
// always. The known families have colours of their own: bronze, brass, copper and gold are orange to vermilion, steels
// and other white metals blue to sky blue, glass and ice sky blue, woods yellow-brown, stone and ceramics bluish green,
// plastics reddish purple. Any other name is one of the palette, by its hash.
glm::vec3 material_colour(std::string_view name);

inline constexpr glm::vec3 kSilentColour{0.62F, 0.62F, 0.62F};  // bodies that do not ring

}  // namespace ringdown::viewer
