// The one way from a file to a body of tetrahedra. Links GPL code (gmsh, CGAL). [worker]
//
//   BodyReader reader("cup.stl", cache_folder);
//   Result<Body> body = reader.read({.unit_m = 0.001, .mesh_size_m = 0.004});
//
// By the file's ending:
//   .node .ele .veg .inp .tet            tetrahedra, read as they are (tet_file.h)
//   .obj .stl .ply .off .gltf .glb       a surface (surface_file.h): diagnosed and mended (surface_repair.h), then
//                                        filled by gmsh (fill.h) where it is sound, else stuffed (stuffing.h)
//   everything else                      gmsh's: a mesh read as it is, or a geometry meshed (gmsh_reader.h)
#pragma once

#include "engine/base/content_cache.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/surface_repair.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::mesh {

enum class Making : std::int32_t { kRead, kMeshed, kFilled, kStuffed };

// "tetrahedra from a file", "geometry meshed by gmsh", "surface filled by gmsh", "surface stuffed".
std::string text_of(Making making);

// Why no body can be made of a surface: it is a sheet, or flat. Nothing where one can.
std::string hopeless(const PreparedSurface& surface, const std::string& name);

struct Body {
  CheckedMesh mesh;
  Making making = Making::kRead;
  std::vector<std::string> notes;  // what was found in a surface, and what was done about it
};

class BodyReader {
 public:
  // `cache` is the folder of a ContentCache; empty: none.
  explicit BodyReader(std::filesystem::path path, std::filesystem::path cache = {});

  // A surface or a geometry, which is meshed as finely as asked. A .geo file may still hold a mesh.
  [[nodiscard]] bool meshes() const;
  [[nodiscard]] bool is_surface() const;

  // The file's surface, mended; in metres, by options.unit_m. It is kept for the next call. Fails when the file is
  // none.
  Result<const PreparedSurface*> surface(const GmshOptions& options);

  // The skin of the body, coarsely; enough to measure it by. Of a mesh of tetrahedra, too.
  Result<TriangleMesh> sketch(const GmshOptions& options);

  // The body. From the cache when it was made before from a file of the same content with the same options
  // (make_through_cache). Options that are for geometries are for surfaces, too, but for edge_size_m. With mesh_size_m
  // = 0 a surface's own triangles are filled. Fails with one sentence: what gmsh, assimp or check_mesh say, or that it
  // encloses nothing.
  Result<Body> read(const GmshOptions& options, const Progress& progress = {});

 private:
  Result<Body> make(const GmshOptions& options, const Progress& progress);
  [[nodiscard]] Result<Body> make_of_tetrahedra(const GmshOptions& options) const;
  Result<Body> make_of_surface(const GmshOptions& options, const Progress& progress);
  Result<Body> stuffed(Body body, const TriangleMesh& mesh, const FillOptions& options, const Progress& progress) const;

  std::filesystem::path path_, cache_;
  std::optional<PreparedSurface> surface_;
  double surface_unit_m_ = 0;
};

// What make() gives, bit for bit; from the cache when it was made before from a file of the same content with the same
// options by the same versions of this program's meshing and of gmsh. Not kept are bodies of files that may read others
// or ask their surroundings (`Include`, `Merge`, `SystemCall` and the like in a .geo or .bdf, a .gltf, TetGen's two),
// and failures.
Result<Body> make_through_cache(const std::filesystem::path& path, const GmshOptions& options,
                                const ContentCache& cache, const std::function<Result<Body>()>& make);

}  // namespace ringdown::mesh
