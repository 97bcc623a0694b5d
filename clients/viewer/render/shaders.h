// The sources of the shaders, GLSL 3.30 without their #version line, and the uniform block that they share. All colours
// are linear; the last pass encodes them as sRGB. Only files of this folder include this header. [any]
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <string>

namespace ringdown::viewer {

// The uniform block Frame in std140 layout: the values shared by everything in one picture.
struct FrameBlock {
  glm::mat4 view_projection{1};
  glm::mat4 light{1};          // scene -> shadow map, 0 ... 1 each
  glm::vec4 eye{0};            // scene
  glm::vec4 to_light{0};       // unit
  glm::vec4 interest{0};       // centre, radius
  glm::vec4 key{0};            // the light's colour
  glm::vec4 sky{0}, earth{0};  // light from above and from below
  glm::vec4 ground{0};         // colour; w: strength of the grid
  glm::vec4 high{0}, low{0};   // the background's top and bottom
  glm::vec4 ink{0};            // colour of the grid and of the outline
  glm::vec4 flash{0};          // colour; w: 1 adds light, 0 covers the picture behind
};

const std::string& body_vertex_shader();    // uniforms pose, size, displacement, to_clip
const std::string& body_shader();           // uniforms colour, glow
const std::string& flat_shader();           // writes 1: for the shadow map and the selection mask
const std::string& ground_vertex_shader();  // uniform pose; draws 4 corners of a strip without attributes
const std::string& ground_shader();         // uniform spacing: distance of the grid's fine lines
const std::string& whole_vertex_shader();   // one triangle over the picture, without attributes
const std::string& background_shader();
const std::string& flash_vertex_shader();  // attributes: those of QuadCorner (gl_shapes.cpp)
const std::string& flash_shader();
const std::string& last_shader();  // uniforms: textures picture and mask; outlined, 0 or 1

}  // namespace ringdown::viewer
