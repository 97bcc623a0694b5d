#include "engine/mesh/files/gltf_mesh.h"
#include "engine/mesh/files/surface_formats.h"
#include "tests/fuzz/targets.h"

#include <string_view>

namespace ringdown::fuzz {

void surface(Bytes file) {
  if (file.empty()) return;
  constexpr std::size_t kMaxTriangles = 10'000;
  const auto kind = static_cast<char>(file.front());
  const std::string_view text(reinterpret_cast<const char*>(file.data()) + 1, file.size() - 1);
  Result<ringdown::mesh::TriangleSoup> read = fail(ErrorKind::bad_input, "");
  if (kind == 'o') {
    read = ringdown::mesh::read_obj(text, "x.obj");
  } else if (kind == 's') {
    read = ringdown::mesh::read_stl(text, "x.stl");
  } else if (kind == 'p') {
    read = ringdown::mesh::read_ply(text, "x.ply");
  } else if (kind == 'f') {
    read = ringdown::mesh::read_off(text, "x.off");
  } else {
    read = ringdown::mesh::read_gltf_mesh(text, "/no/such/folder/x.gltf", kMaxTriangles);
  }
  if (!read) return expect(!read.error().message.empty(), "a refusal has a sentence");
  const auto points = static_cast<std::int32_t>(read->points.size());
  for (const auto& triangle : read->triangles) {
    for (const std::int32_t corner : triangle) expect(corner >= 0 && corner < points, "a triangle's corners exist");
  }
  for (const std::string& note : read->notes) expect(!note.empty(), "a note has a sentence");
}

}  // namespace ringdown::fuzz
