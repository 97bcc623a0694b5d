// The one way from a file to a body of tetrahedra, for programs that trust neither the file nor the libraries that read
// it. [worker]
//
//   BodyReader reader("cup.stl", *cache_folder());
//   Result<Body> body = reader.read({.unit_m = 0.001, .mesh_size_m = 0.004});
//
// A process of its own, the program ringdown-mesher beside this one, reads and meshes the file (body_maker.h, which
// lists the kinds of files). The process has limits of time and memory, can read only the file's folder, start no
// program and write nothing (sandbox.h). Whatever it does, a question here ends with an answer that has been checked
// (body.h), or with one sentence.
//
// The environment's RINGDOWN_MESH_SECONDS and RINGDOWN_MESH_MIB change the limits for each question: 600 s of processor
// time, and half of the computer's memory, at most 16 GiB.
#pragma once

#include "engine/base/process/helper_process.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/body.h"
#include "engine/mesh/files/file_kinds.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace ringdown::mesh {

// The first byte of what ringdown-mesher answers; a packed answer or a packed Error follows.
inline constexpr char kGood = 'g', kBad = 'b';

class BodyReader {
 public:
  // `cache` is the folder of a ContentCache; empty: none.
  explicit BodyReader(std::filesystem::path path, std::filesystem::path cache = {});

  // A surface or a geometry, which is meshed as finely as asked. A .geo file may still hold a mesh.
  [[nodiscard]] bool meshes() const;
  [[nodiscard]] bool is_surface() const;

  // The file's surface, mended; in metres, by options.unit_m. It is kept for the next call. Fails when the file is
  // none.
  Result<const PreparedSurface*> surface(const GmshOptions& options, const Progress& progress = {});

  // The skin of the body, coarsely, and its thinnest wall. Of a mesh of tetrahedra, too.
  Result<Sketch> sketch(const GmshOptions& options, const Progress& progress = {});

  // The body. From the cache when it was made before from a file of the same content with the same options by the same
  // versions of this program's meshing and of gmsh, bit for bit. Not kept are bodies of files that may read others or
  // ask their surroundings (`Include`, `Merge`, `GetEnv` and the like in a .geo or .bdf, a .gltf, TetGen's two), and
  // failures. Options that are for geometries are for surfaces, too, but for edge_size_m. With mesh_size_m = 0 a
  // surface's own triangles are filled. Fails with one sentence: what gmsh, a reader of ours or check_mesh say, that
  // the file encloses nothing, or how its reader ended.
  Result<Body> read(const GmshOptions& options, const Progress& progress = {});

  // Returns the processor time [s] that the reading process has taken so far; 0 when all came from the cache.
  [[nodiscard]] double processor_s() const { return helper_.processor_s(); }

 private:
  Result<void> start();
  Result<std::string> ask(Question question, const GmshOptions& options, const Progress& progress);
  [[nodiscard]] Error why(const HelperAnswer& answer) const;
  template <class Answer>
  [[nodiscard]] Result<Answer> unpacked(const std::string& bytes) const;
  template <class Answer>
  Result<Answer> through_cache(std::string_view kind, Question question, const GmshOptions& options,
                               const Progress& progress);

  std::filesystem::path path_, cache_;
  HelperLimits limits_;
  HelperProcess helper_;
  std::optional<PreparedSurface> surface_;
  SurfaceOptions surface_options_;
};

}  // namespace ringdown::mesh
