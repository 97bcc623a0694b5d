#include "engine/mesh/body_maker.h"

#include "engine/base/file_format.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/files/file_kinds.h"
#include "engine/mesh/files/surface_file.h"
#include "engine/mesh/files/tet_file.h"
#include "engine/mesh/fill.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/mesh/stuffing/stuffed_body.h"
#include "engine/mesh/surface/parted_surface.h"
#include "engine/mesh/surface/simplify.h"
#include "engine/mesh/surface/surface_distance.h"
#include "engine/mesh/surface/surface_gap.h"
#include "engine/mesh/surface/surface_repair.h"
#include "engine/mesh/surface/wall_scale.h"

#include <cmath>
#include <utility>

namespace ringdown::mesh {
namespace {

constexpr Eigen::Index kManyTriangles = 50'000;  // surfaces with fewer triangles are not simplified
constexpr std::size_t kQuickTriangles = 20'000;  // twice the triangles of a first attempt in fill.cpp
constexpr double kQuickShare = 0.005;            // share of the diagonal by which simplifying may move a surface
constexpr double kReach = 0.05;                  // share of the diagonal within which gaps are measured

Result<void> check_unit(const std::filesystem::path& path, const std::optional<double>& unit_m) {
  if (!unit_m || (*unit_m > 0 && std::isfinite(*unit_m))) return {};
  return fail(ErrorKind::bad_input, "the unit of " + path.string() + " must be a positive length in metres");
}

std::vector<std::string> notes_of(const PreparedSurface& surface) {
  std::vector<std::string> notes = surface.notes;
  for (const Finding& finding : surface.found.findings) notes.push_back("found: " + describe(finding));
  for (const std::string& action : surface.actions) notes.push_back("repaired: " + action);
  return notes;
}

std::string note_of_fewer(Eigen::Index before, Eigen::Index after) {
  return formatted("took {} triangles for its {}, for a preview", after, before);
}

std::string note_of_loss(const CheckedMesh& checked) {
  const double gap_m = checked.gaps_m[0];
  return formatted("its mesh has {} volume than the geometry, as if its skin lay {:.2g} mm too far {}",
                   gap_m > 0 ? "less" : "more", 1000 * std::abs(gap_m), gap_m > 0 ? "inside" : "outside");
}

Error unknown_format(const std::filesystem::path& path) {
  return {ErrorKind::bad_input, path.string() + " is not in a format that Ringdown reads, which are " +
                                    endings_of_bodies() + "; export it as glTF, OBJ, STL or PLY"};
}

Result<void> check_takes_parts(const std::filesystem::path& path, const GmshOptions& options) {
  if (options.parts.empty()) return {};
  return fail(ErrorKind::bad_input, path.string() +
                                        " is not a surface, so that its parts cannot be surfaces inside it; name "
                                        "groups of the geometry or mesh: group = \"...\"");
}

}  // namespace

BodyMaker::BodyMaker(std::filesystem::path path) : path_(std::move(path)) {}

Result<const PreparedSurface*> BodyMaker::surface(const GmshOptions& options) {
  const SurfaceOptions wanted = surface_options(options);
  if (auto good = check_unit(path_, options.unit_m); !good) return fail(good);
  if (!surface_ || surface_options_ != wanted) {
    if (!options.parameters.empty())
      return fail(ErrorKind::bad_input, path_.string() + " takes no parameters; only .geo files have them");
    std::vector<std::string> notes;
    Result<TriangleMesh> read = read_surface(path_, &notes);
    if (!read) return fail(read);
    read->nodes *= wanted.unit_m;
    const Eigen::Index triangles = read->triangles.rows();
    if (wanted.quick && triangles > kManyTriangles)
      *read = simplified(*read, kQuickTriangles, kQuickShare * diagonal_of(*read));
    surface_ = prepare(*read, wanted.cavities ? CavityRule::kInside : CavityRule::kWoundTheOtherWay);
    surface_->notes = std::move(notes);
    if (read->triangles.rows() < triangles)
      surface_->actions.push_back(note_of_fewer(triangles, read->triangles.rows()));
    surface_options_ = wanted;
  }
  return &*surface_;
}

Result<Sketch> BodyMaker::sketch(const GmshOptions& options) {
  Sketch sketch;
  if (is_surface_file(path_)) {
    const Result<const PreparedSurface*> prepared = surface(options);
    if (!prepared) return fail(prepared);
    sketch.skin = (*prepared)->mesh;
    if (!(*prepared)->left.sound()) {
      sketch.wall_m = options.wall_scale * wall_of_soup(sketch.skin);
      return sketch;
    }
  } else {
    GmshOptions coarse = options;
    coarse.mesh_size_m = 0;
    coarse.order = 1;
    const Result<Body> body = make(coarse);
    if (!body) return fail(body);
    sketch.skin = skin_of(body->mesh.mesh);
    sketch.sized_by_file = declares_mesh_size(path_) && depends_on_mesh_size(path_, options, diagonal_of(sketch.skin));
  }
  sketch.wall_m = wall_thickness(sketch.skin) * (is_surface_file(path_) ? options.wall_scale : 1);
  return sketch;
}

Result<Body> BodyMaker::make(const GmshOptions& options, const Progress& progress) {
  Result<Body> body = make_as_drawn(options, progress);
  if (!body || options.wall_scale == 1) return body;
  return scale_walls(body->mesh.mesh, options.wall_scale, path_.string()).map([&body] { return std::move(*body); });
}

Result<Body> BodyMaker::make_as_drawn(const GmshOptions& options, const Progress& progress) {
  if (is_surface_file(path_)) return make_of_surface(options, progress);
  if (auto good = check_takes_parts(path_, options); !good) return fail(good);
  if (!format_of(path_)) return fail(unknown_format(path_));
  if (is_of_kind(path_, FileKind::tetrahedra)) return make_of_tetrahedra(options);
  const Making making = is_geometry_file(path_) ? Making::kMeshed : Making::kRead;
  return read_with_gmsh(path_, options).map([making](CheckedMesh mesh) {
    Body body{std::move(mesh), making, {}};
    if (body.mesh.gaps_m.size() > 0) body.notes.push_back(note_of_loss(body.mesh));
    return body;
  });
}

Result<Body> BodyMaker::make_of_tetrahedra(const GmshOptions& options) const {
  if (auto good = check_unit(path_, options.unit_m); !good) return fail(good);
  if (!options.parameters.empty())
    return fail(ErrorKind::bad_input, path_.string() + " takes no parameters; only .geo files have them");
  Result<TetMesh> read = read_tet_file(path_);
  if (!read) return fail(read);
  read->nodes *= options.unit_m.value_or(1);
  return check_mesh(std::move(*read), path_.string()).map([](CheckedMesh mesh) {
    return Body{std::move(mesh), Making::kRead, {}};
  });
}

Result<Body> BodyMaker::make_of_surface(const GmshOptions& options, const Progress& progress) {
  const Result<const PreparedSurface*> prepared = surface(options);
  if (!prepared) return fail(prepared);
  const auto& [mesh, found, left, actions, notes, rough] = **prepared;
  Body body;
  body.making = Making::kFilled;
  body.notes = notes_of(**prepared);
  if (const std::string why = hopeless(**prepared, path_.string()); !why.empty())
    return fail(ErrorKind::bad_input, why);
  if (auto few = check_element_count(path_, {found.volume_m3, found.area_m2, found.diagonal_m}, options.mesh_size_m);
      !few)
    return fail(few);
  if (!options.parts.empty()) return make_of_parts(**prepared, options);
  if (left.sound()) {
    Result<Filled> filled =
        fill(mesh, {options.mesh_size_m, options.order, wall_thickness(mesh), options.quick}, path_.string());
    if (filled) {
      if (!filled->note.empty()) body.notes.push_back(filled->note);
      body.mesh = std::move(filled->mesh);
      body.mesh.gaps_m =
          surface_gaps(body.mesh.mesh, rough.value_or(mesh), kReach * found.diagonal_m, rough.has_value());
      return body;
    }
    body.notes.push_back("not filled by gmsh: " + filled.error().message);
  } else {
    for (const Finding& finding : left.findings) {
      if (!is_harmless(finding.fault)) body.notes.push_back("left: " + describe(finding));
    }
  }
  Result<Body> stuffed = make_stuffed(mesh, {options.mesh_size_m, options.order, 0, options.quick},
                                      options.force_coarse, path_.string(), progress);
  if (stuffed) stuffed->notes.insert(stuffed->notes.begin(), body.notes.begin(), body.notes.end());
  return stuffed;
}

Result<Body> BodyMaker::make_of_parts(const PreparedSurface& surface, const GmshOptions& options) const {
  const auto refuse = [](const std::string& file, const std::string& why) {
    return fail(ErrorKind::bad_input, "{}: {}; a body with inner surfaces needs surfaces without faults", file, why);
  };
  if (!surface.left.sound()) return refuse(path_.string(), describe(surface.left.findings.front()));
  Body body{.mesh = {}, .making = Making::kFilled, .notes = notes_of(surface)};
  std::vector<NamedSurface> inner;
  for (const std::string& part : options.parts) {
    const std::filesystem::path file = path_.parent_path() / part;
    if (!is_surface_file(file)) return refuse(part, "this is not a surface file");
    Result<TriangleMesh> read = read_surface(file);
    if (!read) return fail(read);
    read->nodes *= options.unit_m.value_or(1);
    PreparedSurface own = prepare(*read);
    if (!own.left.sound()) return refuse(part, describe(own.left.findings.front()));
    for (const std::string& note : notes_of(own)) body.notes.push_back(part + ": " + note);
    inner.push_back({part, std::move(own.mesh)});
  }
  const Result<PartedSurface> parted = mesh::part(surface.mesh, inner, path_.filename().string());
  if (!parted) return fail(parted);
  Result<Filled> filled = fill_parts(
      *parted, {options.mesh_size_m, options.order, wall_thickness(parted->mesh), options.quick}, path_.string());
  if (!filled)
    return fail(
        filled.error().kind,
        "cannot mesh {} with its parts: {}; name a smaller mesh size, or thicken the layers between the surfaces",
        path_.string(), filled.error().message);
  if (!filled->note.empty()) body.notes.push_back(filled->note);
  body.mesh = std::move(filled->mesh);
  body.mesh.gaps_m = surface_gaps(body.mesh.mesh, surface.rough.value_or(surface.mesh),
                                  kReach * surface.found.diagonal_m, surface.rough.has_value());
  return body;
}

}  // namespace ringdown::mesh
