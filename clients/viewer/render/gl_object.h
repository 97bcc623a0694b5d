// OpenGL's names, each freed by its owner. Inside this folder only; in the thread of the context.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace ringdown::viewer {

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

inline GlObject make_buffer() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  return {name, [](GLuint n) { glDeleteBuffers(1, &n); }};
}
inline GlObject make_vertex_array() {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  return {name, [](GLuint n) { glDeleteVertexArrays(1, &n); }};
}
inline GlObject make_texture() {
  GLuint name = 0;
  glGenTextures(1, &name);
  return {name, [](GLuint n) { glDeleteTextures(1, &n); }};
}
inline GlObject make_renderbuffer() {
  GLuint name = 0;
  glGenRenderbuffers(1, &name);
  return {name, [](GLuint n) { glDeleteRenderbuffers(1, &n); }};
}
inline GlObject make_framebuffer() {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  return {name, [](GLuint n) { glDeleteFramebuffers(1, &n); }};
}

}  // namespace ringdown::viewer
