#include "clients/viewer/render/flash_quads.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace ringdown::viewer {
namespace {

struct Corner {
  glm::vec3 place;
  glm::vec2 square;  // -1 ... 1
  glm::vec2 looks;   // brightness; the ring's radius in the square, 0 for the spot
};

void add_square(std::vector<Corner>& to, glm::vec3 middle, glm::vec3 across, glm::vec3 upward, glm::vec2 looks) {
  constexpr glm::vec2 kTurn[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
  for (const glm::vec2 at : kTurn) to.push_back({middle + at.x * across + at.y * upward, at, looks});
}

void add_flash(std::vector<Corner>& to, const Flash& flash, const Camera& camera, float scale_m) {
  const float strength = std::clamp(flash.strength, 0.0F, 1.0F), age = std::clamp(flash.age, 0.0F, 1.0F);
  const float reach = scale_m * (0.05F + 0.1F * strength), left = (1 - age) * (1 - age);
  const float bright = (0.35F + 0.65F * strength) * left;
  if (bright <= 0) return;
  const glm::vec3 to_eye = glm::normalize(camera.position_m - flash.point_m);
  const float spot = reach * (0.5F - 0.2F * age);
  add_square(to, flash.point_m + 0.3F * spot * to_eye, spot * camera.right(), spot * camera.up(), {bright, 0});
  const glm::vec3 aside = std::abs(flash.normal.z) < 0.9F ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
  const glm::vec3 across = glm::normalize(glm::cross(aside, flash.normal));
  const float ring = 0.15F + 0.75F * (1 - left);
  add_square(to, flash.point_m + 0.06F * reach * flash.normal, reach * across, reach * glm::cross(flash.normal, across),
             {bright, ring});
}

}  // namespace

FlashQuads::FlashQuads() {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  const auto attribute = [](GLuint number, GLint floats, std::size_t offset) {
    glEnableVertexAttribArray(number);
    glVertexAttribPointer(number, floats, GL_FLOAT, GL_FALSE, sizeof(Corner), reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Corner, place));
  attribute(1, 2, offsetof(Corner, square));
  attribute(2, 2, offsetof(Corner, looks));
  glBindVertexArray(0);
}

void FlashQuads::draw(const SceneFrame& frame, const Camera& camera) {
  std::vector<Corner> corners;
  corners.reserve(12 * frame.flashes.size());
  for (const Flash& flash : frame.flashes) add_flash(corners, flash, camera, frame.interest.radius_m);
  if (corners.empty()) return;
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(Corner)), corners.data(),
               GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
}

}  // namespace ringdown::viewer
