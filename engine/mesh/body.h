// A body as it comes from a file, and how it crosses from the process that reads files to the one that asked for it
// (body_reader.h). [any thread]
//
// unpack_...() returns a struct only if the bytes keep every promise made here, whoever wrote them: numbers are finite
// and in range, a mesh has passed check_mesh(), texts have no control characters. Otherwise it returns nothing.
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
  double mesh_size_m = 0;                    // longest edge, for a geometry; never above a tenth of its diagonal
  double edge_size_m = 0;                    // the same along sharp edges, growing to mesh_size_m inside; 0: no less
  int order = 3;                             // 1: straight elements, 2 to 4: curved ones. For a geometry only
  bool force_coarse = false;                 // of a surface: walls may be thinner than a cell (stuffed_body.h)
  bool cavities = false;                     // of a surface: CavityRule::kInside in place of kWoundTheOtherWay
  bool quick = false;                        // of a surface: with fewer triangles, where it has very many (simplify.h)
  std::map<std::string, double> parameters;  // DefineConstant names of a .geo, in the file's unit
  // Of a surface: files of closed surfaces inside it, in its unit, named from its folder. The elements inside each
  // are a group of that name (parted_surface.h).
  std::vector<std::string> parts;
};

// The options that a surface depends on, before it is meshed.
struct SurfaceOptions {
  double unit_m = 1;
  bool cavities = false, quick = false;

  friend bool operator==(const SurfaceOptions&, const SurfaceOptions&) = default;
};
inline SurfaceOptions surface_options(const GmshOptions& options) {
  return {options.unit_m.value_or(1), options.cavities, options.quick};
}

enum class Making : std::int32_t { kRead, kMeshed, kFilled, kStuffed, kRefilled };

// "tetrahedra from a file", "geometry meshed by gmsh", "surface filled by gmsh", "surface stuffed", "skin of a stuffed
// surface filled by gmsh".
std::string text_of(Making making);

struct Body {
  CheckedMesh mesh;
  Making making = Making::kRead;
  std::vector<std::string> notes;  // what was found in a surface, and what was done about it
  double wall_elements = 0;        // across the thinnest wall, where less than one was asked for; 0: enough
};

// The skin of a body, coarsely, and its thinnest wall (wall_thickness() in surface_distance.h): enough to measure it
// by.
struct Sketch {
  TriangleMesh skin;
  double wall_m = 0;
  bool sized_by_file = false;  // a .geo file whose mesh depends on its own variable mesh_size
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
