#include "engine/mesh/surface_writer.h"

#include "engine/base/atomic_file.h"

#include <cstdio>
#include <string>

namespace ringdown::mesh {

Result<void> write_ply(const TriangleMesh& surface, const std::filesystem::path& path) {
  std::string text =
      "ply\nformat ascii 1.0\ncomment lengths in metres\nelement vertex " + std::to_string(surface.nodes.rows()) +
      "\nproperty double x\nproperty double y\nproperty double z\n" + "element face " +
      std::to_string(surface.triangles.rows()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  char line[120];
  for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) {
    std::snprintf(line, sizeof line, "%.9g %.9g %.9g\n", surface.nodes(n, 0), surface.nodes(n, 1), surface.nodes(n, 2));
    text += line;
  }
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto row = surface.triangles.row(t);
    std::snprintf(line, sizeof line, "3 %d %d %d\n", row[0], row[1], row[2]);
    text += line;
  }
  return write_file_atomically(path, text);
}

}  // namespace ringdown::mesh
