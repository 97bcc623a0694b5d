#include "engine/mesh/body_maker.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/file_kinds.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/stuffing.h"
#include "engine/mesh/surface_check.h"
#include "engine/mesh/surface_distance.h"
#include "engine/mesh/surface_file.h"
#include "engine/mesh/surface_repair.h"
#include "engine/mesh/tet_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace ringdown::mesh {
namespace {

TriangleMesh triangles_of(const TetMesh& mesh) {
  const Boundary surface = boundary_of(mesh);
  TriangleMesh skin;
  skin.nodes.resize(static_cast<Eigen::Index>(surface.nodes.size()), 3);
  skin.triangles.resize(static_cast<Eigen::Index>(surface.triangles.size()), 3);
  for (std::size_t n = 0; n < surface.nodes.size(); ++n) {
    skin.nodes.row(static_cast<Eigen::Index>(n)) = mesh.nodes.row(surface.nodes[n]);
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      skin.triangles(static_cast<Eigen::Index>(t), i) = static_cast<std::int32_t>(surface.triangles[t][i]);
    }
  }
  return skin;
}

Result<void> check_unit(const std::filesystem::path& path, const std::optional<double>& unit_m) {
  if (!unit_m || (*unit_m > 0 && std::isfinite(*unit_m))) return {};
  return fail(ErrorKind::bad_input, "the unit of " + path.string() + " must be a positive length in metres");
}

struct StuffSize {
  double size_m = 0;
  bool bounded = false;
};

// Cells that resolve the thinnest wall, but no more elements than can be solved with that order.
StuffSize stuff_size(const TriangleMesh& surface, const FillOptions& options) {
  constexpr double kCellsPerWall = 2;
  constexpr double kElementsPerCube = 12;  // of the lattice
  constexpr std::array kMaxElements = {200e3, 40e3, 12e3, 5e3};
  const Eigen::RowVector3d box = surface.nodes.colwise().maxCoeff() - surface.nodes.colwise().minCoeff();
  const double volume = std::abs(diagnose(surface).volume_m3), diagonal = box.norm();
  const double asked = options.size_m > 0 ? options.size_m : diagonal / 20;
  const double wanted = options.wall_m > 0 ? std::min(asked, options.wall_m / kCellsPerWall) : asked;
  const double finest =
      std::cbrt(kElementsPerCube * volume / kMaxElements.at(static_cast<std::size_t>(options.order - 1)));
  return {std::max(wanted, finest), wanted < finest};
}

std::vector<std::string> notes_of(const PreparedSurface& surface) {
  std::vector<std::string> notes;
  for (const Finding& finding : surface.found.findings) notes.push_back("found: " + describe(finding));
  for (const std::string& action : surface.actions) notes.push_back("repaired: " + action);
  return notes;
}

}  // namespace

BodyMaker::BodyMaker(std::filesystem::path path) : path_(std::move(path)) {}

Result<const PreparedSurface*> BodyMaker::surface(const GmshOptions& options) {
  const double unit_m = options.unit_m.value_or(1);
  if (auto good = check_unit(path_, options.unit_m); !good) return fail(good.error());
  if (!surface_ || surface_unit_m_ != unit_m || surface_cavities_ != options.cavities) {
    if (!options.parameters.empty())
      return fail(ErrorKind::bad_input, path_.string() + " takes no parameters; only .geo files have them");
    Result<TriangleMesh> read = read_surface(path_);
    if (!read) return fail(read.error());
    read->nodes *= unit_m;
    surface_ = prepare(*read, options.cavities ? CavityRule::kInside : CavityRule::kWoundTheOtherWay);
    surface_unit_m_ = unit_m;
    surface_cavities_ = options.cavities;
  }
  return &*surface_;
}

Result<Sketch> BodyMaker::sketch(const GmshOptions& options) {
  Sketch sketch;
  if (is_surface_file(path_)) {
    const Result<const PreparedSurface*> prepared = surface(options);
    if (!prepared) return fail(prepared.error());
    sketch.skin = (*prepared)->mesh;
  } else {
    GmshOptions coarse = options;
    coarse.mesh_size_m = 0;
    coarse.order = 1;
    const Result<Body> body = make(coarse);
    if (!body) return fail(body.error());
    sketch.skin = triangles_of(body->mesh.mesh);
  }
  sketch.wall_m = wall_thickness(sketch.skin);
  return sketch;
}

Result<Body> BodyMaker::make(const GmshOptions& options, const Progress& progress) {
  if (is_surface_file(path_)) return make_of_surface(options, progress);
  if (is_tet_file(path_)) return make_of_tetrahedra(options);
  const Making making = is_geometry_file(path_) ? Making::kMeshed : Making::kRead;
  return read_with_gmsh(path_, options).map([making](CheckedMesh mesh) { return Body{std::move(mesh), making, {}}; });
}

Result<Body> BodyMaker::make_of_tetrahedra(const GmshOptions& options) const {
  if (auto good = check_unit(path_, options.unit_m); !good) return fail(good.error());
  if (!options.parameters.empty())
    return fail(ErrorKind::bad_input, path_.string() + " takes no parameters; only .geo files have them");
  Result<TetMesh> read = read_tet_file(path_);
  if (!read) return fail(read.error());
  read->nodes *= options.unit_m.value_or(1);
  return check_mesh(std::move(*read), path_.string()).map([](CheckedMesh mesh) {
    return Body{std::move(mesh), Making::kRead, {}};
  });
}

Result<Body> BodyMaker::make_of_surface(const GmshOptions& options, const Progress& progress) {
  const Result<const PreparedSurface*> prepared = surface(options);
  if (!prepared) return fail(prepared.error());
  const auto& [mesh, found, left, actions] = **prepared;
  Body body;
  body.making = Making::kFilled;
  body.notes = notes_of(**prepared);
  if (const std::string why = hopeless(**prepared, path_.string()); !why.empty())
    return fail(ErrorKind::bad_input, why);
  if (auto few = check_element_count(path_, {found.volume_m3, found.area_m2, found.diagonal_m}, options.mesh_size_m);
      !few)
    return fail(few.error());
  const double wall_m = wall_thickness(mesh);
  if (left.sound()) {
    Result<Filled> filled = fill(mesh, {options.mesh_size_m, options.order, wall_m}, path_.string());
    if (filled) {
      if (!filled->note.empty()) body.notes.push_back(filled->note);
      body.mesh = std::move(filled->mesh);
      return body;
    }
    body.notes.push_back("not filled by gmsh: " + filled.error().message);
  } else {
    for (const Finding& finding : left.findings) {
      if (!is_harmless(finding.fault)) body.notes.push_back("left: " + describe(finding));
    }
  }
  return stuffed(std::move(body), mesh, {options.mesh_size_m, options.order, wall_m}, progress);
}

Result<Body> BodyMaker::stuffed(Body body, const TriangleMesh& mesh, const FillOptions& options,
                                const Progress& progress) const {
  const StuffSize size = stuff_size(mesh, options);
  Result<Stuffed> stuffed = stuff(mesh, {.size_m = size.size_m}, progress);
  if (!stuffed) {
    return fail(stuffed.error().kind, path_.string() + " cannot be stuffed: " + stuffed.error().message);
  }
  Result<CheckedMesh> checked = check_mesh(std::move(stuffed->mesh), path_.string());
  if (!checked) return fail(checked.error());
  char text[160];
  std::snprintf(text, sizeof text, "stuffed with cells of %.3g mm%s", 1000 * size.size_m,
                size.bounded ? ", coarser than its walls ask for; finer would be too much to solve" : "");
  body.notes.emplace_back(text);
  if (stuffed->crumbs > 0) body.notes.push_back("left out: " + std::to_string(stuffed->crumbs) + " crumbs");
  body.mesh = std::move(*checked);
  body.making = Making::kStuffed;
  return body;
}

}  // namespace ringdown::mesh
