#include "clients/viewer/render/gl.h"

#include <algorithm>
#include <array>

namespace ringdown::viewer {
namespace {

GlObject make(void (*generate)(GLsizei, GLuint*), void (*free)(GLuint)) {
  GLuint name = 0;
  generate(1, &name);
  return {name, free};
}

using Log = std::array<char, 512>;

Error refused(const char* name, const char* what, const Log& log) {
  std::string said(log.data());
  std::replace(said.begin(), said.end(), '\n', ' ');
  return {ErrorKind::refused,
          formatted("this OpenGL driver refuses {} of '{}' ({}); try another driver", what, name, said)};
}

Result<GlObject> compile(const char* name, GLenum kind, const std::string& source) {
  GlObject shader(glCreateShader(kind), [](GLuint n) { glDeleteShader(n); });
  const std::array<const char*, 2> parts = {"#version 330 core\n", source.c_str()};
  glShaderSource(shader.name(), 2, parts.data(), nullptr);
  glCompileShader(shader.name());
  GLint good = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  Log log = {};
  glGetShaderInfoLog(shader.name(), log.size(), nullptr, log.data());
  return fail(refused(name, kind == GL_VERTEX_SHADER ? "the vertex shader" : "the fragment shader", log));
}

void filter(GLint how, GLint edge) {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, how);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, how);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, edge);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, edge);
}

bool attach(const GlObject& framebuffer, const GlObject& texture, GLint format, GLenum layout, GLenum type, int width,
            int height) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, layout, type, nullptr);
  filter(GL_LINEAR, GL_CLAMP_TO_EDGE);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name(), 0);
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

}  // namespace

GlObject make_buffer() {
  return make(glGenBuffers, [](GLuint name) { glDeleteBuffers(1, &name); });
}
GlObject make_vertex_array() {
  return make(glGenVertexArrays, [](GLuint name) { glDeleteVertexArrays(1, &name); });
}
GlObject make_texture() {
  return make(glGenTextures, [](GLuint name) { glDeleteTextures(1, &name); });
}
GlObject make_renderbuffer() {
  return make(glGenRenderbuffers, [](GLuint name) { glDeleteRenderbuffers(1, &name); });
}
GlObject make_framebuffer() {
  return make(glGenFramebuffers, [](GLuint name) { glDeleteFramebuffers(1, &name); });
}

Result<GlProgram> GlProgram::link(const char* name, const std::string& vertex, const std::string& fragment) {
  const Result<GlObject> first = compile(name, GL_VERTEX_SHADER, vertex);
  if (!first) return fail(first);
  const Result<GlObject> second = compile(name, GL_FRAGMENT_SHADER, fragment);
  if (!second) return fail(second);
  GlProgram made;
  made.program_ = GlObject(glCreateProgram(), [](GLuint n) { glDeleteProgram(n); });
  const GLuint program = made.program_.name();
  for (const auto* shader : {&*first, &*second}) glAttachShader(program, shader->name());
  glLinkProgram(program);
  for (const auto* shader : {&*first, &*second}) glDetachShader(program, shader->name());
  GLint good = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good != GL_TRUE) {
    Log log = {};
    glGetProgramInfoLog(program, log.size(), nullptr, log.data());
    return fail(refused(name, "to link the shaders", log));
  }
  const GLuint block = glGetUniformBlockIndex(program, "Frame");
  if (block != GL_INVALID_INDEX) glUniformBlockBinding(program, block, 0);
  return made;
}

ShadowMap::ShadowMap() {
  glBindTexture(GL_TEXTURE_2D, depth.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kSide, kSide, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  filter(GL_LINEAR, GL_CLAMP_TO_BORDER);
  constexpr std::array<float, 4> kFarthest = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, kFarthest.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
}

PictureTargets::PictureTargets(int w, int h) : width(w), height(h) {
  GLint max = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &max);
  const GLint samples = std::min(max, kSamples);
  glBindRenderbuffer(GL_RENDERBUFFER, colour.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA16F, w, h);
  glBindRenderbuffer(GL_RENDERBUFFER, depth.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, w, h);
  glBindFramebuffer(GL_FRAMEBUFFER, many.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth.name());
  complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  complete = attach(linear, linear_texture, GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, w, h) && complete;
  complete = attach(mask, mask_texture, GL_R8, GL_RED, GL_UNSIGNED_BYTE, w, h) && complete;
  complete = attach(last, last_texture, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, w, h) && complete;
}

}  // namespace ringdown::viewer
