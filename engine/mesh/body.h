// A body as read from a file, and its form as bytes, in which the process that reads files returns it to the process
// that asked (body_reader.h). [any thread]
//
// The bytes are not trusted. unpack_...() returns a struct only if numbers are finite and in range, a mesh has passed
// check_mesh(), and texts have no control characters; otherwise nothing.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/surface/surface_report.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::mesh {

struct GmshOptions {
  std::optional<double> unit_m;              // length of one unit, e.g. 0.001 for millimetres; none: unit_in_file()
  double mesh_size_m = 0;                    // longest edge, for geometries; at most a tenth of the diagonal
  double edge_size_m = 0;                    // longest edge along sharp edges, growing to mesh_size_m; 0: mesh_size_m
  int order = 3;                             // 1: straight elements, 2 to 4: curved elements; for geometries only
  bool force_coarse = false;                 // surfaces: walls may be thinner than a cell (stuffed_body.h)
  bool cavities = false;                     // surfaces: CavityRule::kInside instead of kWoundTheOtherWay
  bool quick = false;                        // surfaces: reduces the triangles if there are very many (simplify.h)
  double wall_scale = 1;                     // of the walls along their normal (wall_scale.h)
  std::map<std::string, double> parameters;  // DefineConstant names of a .geo, in the file's unit
  // For surfaces: files of closed surfaces inside the surface, in its unit, relative to its folder. The elements inside
  // each form a group of that name (parted_surface.h).
  std::vector<std::string> parts;
};

// The options that change a surface before meshing.
struct SurfaceOptions {
  double unit_m = 1;
  bool cavities = false, quick = false;

  friend bool operator==(const SurfaceOptions&, const SurfaceOptions&) = default;
};
inline SurfaceOptions surface_options(const GmshOptions& options) {
  return {options.unit_m.value_or(1), options.cavities, options.quick};
}

enum class Making : std::int32_t { kRead, kMeshed, kFilled, kStuffed, kRefilled };

// Returns "tetrahedra from a file", "geometry meshed by gmsh", "surface filled by gmsh", "surface stuffed" or "skin of
// a stuffed surface filled by gmsh".
std::string text_of(Making making);

struct Body {
  CheckedMesh mesh;
  Making making = Making::kRead;
  std::vector<std::string> notes;  // faults found in a surface, and their repairs
  double wall_elements = 0;        // elements across the thinnest wall, if less than one was requested; 0: enough
};

// A coarse skin of a body and its thinnest wall (wall_thickness() in surface_distance.h), for measuring the body.
struct Sketch {
  TriangleMesh skin;
  double wall_m = 0;
  bool sized_by_file = false;  // true for a .geo file whose mesh depends on its own variable mesh_size
};

// A question that ringdown-mesher answers about a file.
enum class Question : std::int32_t { kSurface, kSketch, kBody };

std::string packed(Question question, const GmshOptions& options);
bool unpack_question(std::string_view bytes, Question& question, GmshOptions& options);

std::string packed(const Body& body);
std::string packed(const Sketch& sketch);
std::string packed(const PreparedSurface& surface);
std::string packed(const Error& error);
bool unpack(std::string_view bytes, Body& body);
bool unpack(std::string_view bytes, Sketch& sketch);
bool unpack(std::string_view bytes, PreparedSurface& surface);
bool unpack(std::string_view bytes, Error& error);

}  // namespace ringdown::mesh
