#include "clients/viewer/render/gl_mesh.h"

#include <algorithm>
#include <cstddef>

namespace ringdown::viewer {
namespace {

struct Corner {
  glm::vec3 a, b;
};

void upload_pairs(GLuint buffer, const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  std::vector<Corner> pairs(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) pairs[i] = {a[i], b[i]};
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(pairs.size() * sizeof(Corner)), pairs.data(), GL_STATIC_DRAW);
}

void point_attributes(GLuint buffer, GLuint first) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  for (const GLuint k : {0U, 1U}) {
    glEnableVertexAttribArray(first + k);
    glVertexAttribPointer(first + k, 3, GL_FLOAT, GL_FALSE, sizeof(Corner),
                          reinterpret_cast<const void*>(k * sizeof(glm::vec3)));
  }
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

GlMesh::Moved GlMesh::upload(const Displacement& displacement) const {
  Moved moved{displacement, make_buffer(), make_vertex_array()};
  const std::vector<glm::vec3> moves = corner_moves(mesh_, *displacement);
  upload_pairs(moved.buffer.name(), moves, normal_changes(mesh_, moves));
  glBindVertexArray(moved.array.name());
  describe_corners();
  point_attributes(moved.buffer.name(), 2);
  return moved;
}

void GlMesh::draw(const Displacement& displacement) {
  GLuint array = array_.name();
  if (displacement) {
    auto found =
        std::find_if(moved_.begin(), moved_.end(), [&](const Moved& moved) { return moved.what == displacement; });
    if (found == moved_.end()) found = moved_.insert(found, upload(displacement));
    found->drawn = true;
    array = found->array.name();
  }
  glBindVertexArray(array);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh_.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

void GlMesh::end_frame() {
  std::erase_if(moved_, [](const Moved& moved) { return !moved.drawn; });
  for (Moved& moved : moved_) moved.drawn = false;
}

}  // namespace ringdown::viewer
