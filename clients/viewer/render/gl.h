// The few OpenGL objects the renderer needs, as C++ values: a name that is deleted with its owner, a linked program,
// and the framebuffers that a picture passes through. Only files of this folder include this header. Every call needs
// the renderer's context to be current. [context thread]
#pragma once

#include "engine/base/result.h"

#include <epoxy/gl.h>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <utility>

namespace ringdown::viewer {

// The name of one OpenGL object. The destructor deletes the object; a moved-from GlObject owns nothing.
class GlObject {
 public:
  GlObject() = default;
  GlObject(GLuint name, void (*free)(GLuint)) : name_(name), free_(free) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)), free_(other.free_) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(free_, other.free_);
    return *this;
  }
  ~GlObject() {
    if (name_ != 0) free_(name_);
  }
  [[nodiscard]] GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
  void (*free_)(GLuint) = nullptr;
};

GlObject make_buffer();
GlObject make_vertex_array();
GlObject make_texture();
GlObject make_renderbuffer();
GlObject make_framebuffer();

// A vertex shader and a fragment shader, linked.
class GlProgram {
 public:
  // Takes the sources without their #version line, and gives the uniform block `Frame` binding 0. An error names the
  // program by `name` and quotes the driver's message.
  static Result<GlProgram> link(const char* name, const std::string& vertex, const std::string& fragment);

  void use() const { glUseProgram(program_.name()); }

  // Sets a uniform of this program, which must be the one in use. A name the program does not have is ignored.
  void set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
  void set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
  void set(const char* uniform, const glm::vec3& value) const { glUniform3fv(location(uniform), 1, &value[0]); }
  void set(const char* uniform, const glm::mat4& value) const {
    glUniformMatrix4fv(location(uniform), 1, GL_FALSE, &value[0][0]);
  }

 private:
  [[nodiscard]] GLint location(const char* uniform) const { return glGetUniformLocation(program_.name(), uniform); }
  GlObject program_;
};

// Depth as seen from the light. Sampled with a comparison, filtered between texels; outside the map the depth is 1.
struct ShadowMap {
  static constexpr int kSide = 1024;  // texels
  ShadowMap();
  GlObject depth = make_texture(), framebuffer = make_framebuffer();
};

// The framebuffers of one picture, all of the same size in pixels.
struct PictureTargets {
  static constexpr GLint kSamples = 4;  // fewer where the driver offers fewer
  PictureTargets(int width, int height);

  int width, height;
  bool complete = false;  // whether the driver can draw into all of them
  GlObject colour = make_renderbuffer(), depth = make_renderbuffer(),
           many = make_framebuffer();                                     // multisampled, half float
  GlObject linear_texture = make_texture(), linear = make_framebuffer();  // the multisampled picture, resolved
  GlObject mask_texture = make_texture(), mask = make_framebuffer();      // one byte: 1 where the selected body is
  GlObject last_texture = make_texture(), last = make_framebuffer();      // the result: sRGB, 8 bits
};

}  // namespace ringdown::viewer
