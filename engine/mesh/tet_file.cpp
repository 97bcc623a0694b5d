#include "engine/mesh/tet_file.h"

namespace ringdown::mesh {

bool is_tet_file(const std::filesystem::path& path) {
  return path.extension() == ".node" || path.extension() == ".ele" || path.extension() == ".veg" ||
         path.extension() == ".tet";
}

Result<TetMesh> read_tet_file(const std::filesystem::path&) { return fail("not yet"); }

}  // namespace ringdown::mesh
