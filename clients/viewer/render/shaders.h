// The shaders' sources, GLSL 3.30 without their #version line. All colours in them are linear but for the last pass,
// which encodes. Inside this folder only.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <string>

namespace ringdown::viewer {

// The uniform block Frame, in std140's layout: what is the same for all that one picture draws.
struct FrameBlock {
  glm::mat4 view_projection{1};
  glm::mat4 light{1};          // scene -> shadow map, 0 ... 1 each
  glm::vec4 eye{0};            // scene
  glm::vec4 to_light{0};       // unit
  glm::vec4 interest{0};       // centre, radius
  glm::vec4 key{0};            // the light's colour
  glm::vec4 sky{0}, earth{0};  // light from above and from below
  glm::vec4 ground{0};         // its own colour; w: how strongly the grid is seen
  glm::vec4 high{0}, low{0};   // the background's top and bottom
  glm::vec4 ink{0};            // of the grid and of the outline
  glm::vec4 flash{0};          // w: 1 adds light, 0 covers what is behind
};

const std::string& body_vertex_shader();    // uniforms pose, size, displacement
const std::string& body_shader();           // uniforms colour, glow
const std::string& flat_shader();           // writes 1: for the shadow map and the mask of what is selected
const std::string& ground_vertex_shader();  // uniform pose; draws 4 corners of a strip without attributes
const std::string& ground_shader();         // uniform spacing: of the grid's fine lines
const std::string& whole_vertex_shader();   // one triangle over the picture, without attributes
const std::string& background_shader();
const std::string&
flash_vertex_shader();  // attributes: position, place in the square -1 ... 1, (brightness, ring's radius)
const std::string& flash_shader();
const std::string& last_shader();  // uniforms picture, mask: textures; outlined: 0 or 1

}  // namespace ringdown::viewer
