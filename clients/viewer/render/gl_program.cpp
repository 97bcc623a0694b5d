#include "clients/viewer/render/gl_program.h"

#include <algorithm>
#include <array>

namespace ringdown::viewer {
namespace {

using Log = std::array<char, 512>;

Error refused(const char* name, const char* what, const Log& log) {
  std::string said(log.data());
  std::replace(said.begin(), said.end(), '\n', ' ');
  return {ErrorKind::refused,
          std::string("this OpenGL driver refuses ") + what + " of '" + name + "' (" + said + "); try another driver"};
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

}  // namespace

Result<GlProgram> GlProgram::link(const char* name, const std::string& vertex, const std::string& fragment) {
  const Result<GlObject> first = compile(name, GL_VERTEX_SHADER, vertex);
  if (!first) return fail(first.error());
  const Result<GlObject> second = compile(name, GL_FRAGMENT_SHADER, fragment);
  if (!second) return fail(second.error());
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

}  // namespace ringdown::viewer
