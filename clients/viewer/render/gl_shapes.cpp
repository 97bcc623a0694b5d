#include "clients/viewer/render/gl_shapes.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace ringdown::viewer {
namespace {

struct VectorPair {
  glm::vec3 a, b;
};

void upload_pairs(GLuint buffer, const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  std::vector<VectorPair> pairs(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) pairs[i] = {a[i], b[i]};
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(pairs.size() * sizeof(VectorPair)), pairs.data(),
               GL_STATIC_DRAW);
}

void point_attributes(GLuint buffer, GLuint first) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  for (const GLuint k : {0U, 1U}) {
    glEnableVertexAttribArray(first + k);
    glVertexAttribPointer(first + k, 3, GL_FLOAT, GL_FALSE, sizeof(VectorPair),
                          reinterpret_cast<const void*>(k * sizeof(glm::vec3)));
  }
}

struct QuadCorner {
  glm::vec3 position_m;
  glm::vec2 square;      // position within the quad, -1 ... 1 along both edges
  glm::vec2 appearance;  // brightness, and the radius of the ring within the square; radius 0 draws the spot
};

// Two triangles of a quad about `middle`, which reaches by `across` and `upward` from there.
void add_square(std::vector<QuadCorner>& to, glm::vec3 middle, glm::vec3 across, glm::vec3 upward,
                glm::vec2 appearance) {
  constexpr glm::vec2 kTurn[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
  for (const glm::vec2 at : kTurn) to.push_back({middle + at.x * across + at.y * upward, at, appearance});
}

// The quads of one flash. While the flash ages from 0 to 1 its light fades, its spot shrinks and its ring widens.
void add_flash(std::vector<QuadCorner>& to, const Flash& flash, const Camera& camera, float scale_m) {
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

GlMesh::GlMesh(const DrawnMesh& mesh) : mesh_(mesh) {
  upload_pairs(corners_.name(), mesh.positions, mesh.normals);
  glBindVertexArray(array_.name());
  describe_corners();
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(mesh.triangles[0])),
               mesh.triangles.data(), GL_STATIC_DRAW);
  glBindVertexArray(0);
}

void GlMesh::describe_corners() const {
  point_attributes(corners_.name(), 0);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
}

GlMesh::Displaced GlMesh::upload(const Displacement& displacement) const {
  Displaced one{displacement, make_buffer(), make_vertex_array()};
  const std::vector<glm::vec3> moves = corner_moves(mesh_, *displacement);
  upload_pairs(one.buffer.name(), moves, normal_changes(mesh_, moves));
  glBindVertexArray(one.array.name());
  describe_corners();
  point_attributes(one.buffer.name(), 2);
  return one;
}

void GlMesh::draw(const Displacement& displacement) {
  GLuint array = array_.name();
  if (displacement) {
    auto found = std::find_if(displaced_.begin(), displaced_.end(),
                              [&](const Displaced& one) { return one.what == displacement; });
    if (found == displaced_.end()) found = displaced_.insert(found, upload(displacement));
    found->drawn = true;
    array = found->array.name();
  }
  glBindVertexArray(array);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh_.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

void GlMesh::end_frame() {
  std::erase_if(displaced_, [](const Displaced& one) { return !one.drawn; });
  for (Displaced& one : displaced_) one.drawn = false;
}

FlashQuads::FlashQuads() {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  const auto attribute = [](GLuint number, GLint floats, std::size_t offset) {
    glEnableVertexAttribArray(number);
    glVertexAttribPointer(number, floats, GL_FLOAT, GL_FALSE, sizeof(QuadCorner),
                          reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(QuadCorner, position_m));
  attribute(1, 2, offsetof(QuadCorner, square));
  attribute(2, 2, offsetof(QuadCorner, appearance));
  glBindVertexArray(0);
}

void FlashQuads::draw(const SceneFrame& frame, const Camera& camera) {
  std::vector<QuadCorner> corners;
  corners.reserve(12 * frame.flashes.size());
  for (const Flash& flash : frame.flashes) add_flash(corners, flash, camera, frame.interest.radius_m);
  if (corners.empty()) return;
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(QuadCorner)), corners.data(),
               GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
}

}  // namespace ringdown::viewer
