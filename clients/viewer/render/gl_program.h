// A vertex and a fragment shader, linked. Inside this folder only; in the thread of the context.
#pragma once

#include "clients/viewer/render/gl_object.h"
#include "engine/base/result.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <string>

namespace ringdown::viewer {

class GlProgram {
 public:
  // Sources without their #version line. The uniform block `Frame` gets binding 0. `name` stands in errors, with what
  // the driver says.
  static Result<GlProgram> link(const char* name, const std::string& vertex, const std::string& fragment);

  void use() const { glUseProgram(program_.name()); }
  // Of the program in use; a uniform that it lacks is ignored.
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

}  // namespace ringdown::viewer
