// Makes a body of tetrahedra from a file. Runs in the process that reads files; other processes use body_reader.h.
// Links GPL code (gmsh, CGAL). [worker]
//
// By the kind of the file (engine/base/file_format.h):
//   tetrahedra            read as they are (tet_file.h)
//   surface, gltf         a surface (surface_file.h): diagnosed and mended (surface_repair.h), then filled by gmsh
//                         (fill.h) where it is sound, else stuffed (stuffed_body.h)
//   gmsh_mesh             a mesh that gmsh reads as it is (gmsh_reader.h)
//   geometry, program     meshed by gmsh (gmsh_reader.h)
// The walls of each are then scaled, if that is asked for (wall_scale.h). Files with other endings are refused; the
// error lists the supported endings.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/body.h"

#include <filesystem>
#include <optional>

namespace ringdown::mesh {

// Answers the three questions of BodyReader, without a cache.
class BodyMaker {
 public:
  explicit BodyMaker(std::filesystem::path path);

  Result<const PreparedSurface*> surface(const GmshOptions& options);  // the result is kept for the next call
  Result<Sketch> sketch(const GmshOptions& options);
  Result<Body> make(const GmshOptions& options, const Progress& progress = {});

 private:
  Result<Body> make_as_drawn(const GmshOptions& options, const Progress& progress);
  [[nodiscard]] Result<Body> make_of_tetrahedra(const GmshOptions& options) const;
  Result<Body> make_of_surface(const GmshOptions& options, const Progress& progress);
  Result<Body> make_of_parts(const PreparedSurface& surface, const GmshOptions& options) const;

  std::filesystem::path path_;
  std::optional<PreparedSurface> surface_;
  SurfaceOptions surface_options_;
};

}  // namespace ringdown::mesh
