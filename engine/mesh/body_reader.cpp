#include "engine/mesh/body_reader.h"

#include "engine/base/atomic_file.h"
#include "engine/base/byte_stream.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/stuffing.h"
#include "engine/mesh/surface_distance.h"
#include "engine/mesh/surface_file.h"
#include "engine/mesh/tet_file.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cctype>
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

std::string text_of(Making making) {
  switch (making) {
    case Making::kRead:
      return "tetrahedra from a file";
    case Making::kMeshed:
      return "geometry meshed by gmsh";
    case Making::kFilled:
      return "surface filled by gmsh";
    case Making::kStuffed:
      return "surface stuffed";
  }
  return "";
}

std::string hopeless(const PreparedSurface& surface, const std::string& name) {
  const auto has = [&surface](Fault fault) { return surface.found.find(fault) || surface.left.find(fault); };
  if (!has(Fault::kSheet) && !has(Fault::kNoVolume)) return "";
  return name + " encloses nothing: it is an open sheet, or flat; give it a thickness in a mesh tool";
}

BodyReader::BodyReader(std::filesystem::path path, std::filesystem::path cache)
    : path_(std::move(path)), cache_(std::move(cache)) {}

bool BodyReader::is_surface() const { return is_surface_file(path_); }
bool BodyReader::meshes() const { return is_surface() || is_geometry_file(path_); }

Result<const PreparedSurface*> BodyReader::surface(const GmshOptions& options) {
  const double unit_m = options.unit_m.value_or(1);
  if (auto good = check_unit(path_, options.unit_m); !good) return fail(good.error());
  if (!surface_ || surface_unit_m_ != unit_m) {
    if (!options.parameters.empty())
      return fail(ErrorKind::bad_input, path_.string() + " takes no parameters; only .geo files have them");
    Result<TriangleMesh> read = read_surface(path_);
    if (!read) return fail(read.error());
    read->nodes *= unit_m;
    surface_ = prepare(*read);
    surface_unit_m_ = unit_m;
  }
  return &*surface_;
}

Result<TriangleMesh> BodyReader::sketch(const GmshOptions& options) {
  if (is_surface()) {
    return surface(options).map([](const PreparedSurface* prepared) { return prepared->mesh; });
  }
  GmshOptions coarse = options;
  coarse.mesh_size_m = 0;
  coarse.order = 1;
  return read(coarse).map([](const Body& body) { return triangles_of(body.mesh.mesh); });
}

Result<Body> BodyReader::read(const GmshOptions& options, const Progress& progress) {
  if (cache_.empty()) return make(options, progress);
  return make_through_cache(path_, options, ContentCache(cache_), [&] { return make(options, progress); });
}

Result<Body> BodyReader::make(const GmshOptions& options, const Progress& progress) {
  if (is_surface()) return make_of_surface(options, progress);
  if (is_tet_file(path_)) return make_of_tetrahedra(options);
  const Making making = is_geometry_file(path_) ? Making::kMeshed : Making::kRead;
  return read_with_gmsh(path_, options).map([making](CheckedMesh mesh) { return Body{std::move(mesh), making, {}}; });
}

Result<Body> BodyReader::make_of_tetrahedra(const GmshOptions& options) const {
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

Result<Body> BodyReader::make_of_surface(const GmshOptions& options, const Progress& progress) {
  const Result<const PreparedSurface*> prepared = surface(options);
  if (!prepared) return fail(prepared.error());
  const auto& [mesh, found, left, actions] = **prepared;
  Body body;
  body.making = Making::kFilled;
  body.notes = notes_of(**prepared);
  if (const std::string why = hopeless(**prepared, path_.string()); !why.empty())
    return fail(ErrorKind::bad_input, why);
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

Result<Body> BodyReader::stuffed(Body body, const TriangleMesh& mesh, const FillOptions& options,
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

namespace {

constexpr std::string_view kKind = "mesh";
constexpr int kFormat = 3;                                     // of an entry, and of how bodies are made
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;  // bytes; a larger file is read each time

// Words of gmsh's language and of mesh formats by which a result depends on more than the file and its parameters. One
// in a comment costs no more than meshing anew.
constexpr std::array kElsewhere = {"include", "merge",     "shapefromfile", "systemcall",  "onelab",
                                   "getenv",  "getstring", "getnumber",     "exists",      "rand",
                                   "cpu",     "memory",    "currentdir",    "absolutepath"};

bool looks_elsewhere(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::any_of(kElsewhere.begin(), kElsewhere.end(),
                     [&text](const char* word) { return text.find(word) != std::string::npos; });
}

// Read as text by gmsh's parser, or as a keyword format with includes; other formats stand alone.
bool is_program(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension.starts_with(".geo") || extension == ".bdf" || extension == ".nas";
}

// The body is in several files.
bool has_companions(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".gltf" || extension == ".node" || extension == ".ele";
}

// Every option by name: a new one that is not in the key does not compile.
ContentHash key_of(const std::filesystem::path& path, const std::string& text, const GmshOptions& options) {
  const auto& [unit_m, mesh_size_m, edge_size_m, order, parameters] = options;
  ContentHasher hasher;
  hasher.value(kFormat).text(GMSH_API_VERSION).text(path.extension().string()).text(text);
  hasher.value(unit_m.value_or(0)).value(mesh_size_m).value(edge_size_m).value(order);
  for (const auto& [name, value] : parameters) hasher.text(name).value(value);
  return hasher.hash();
}

std::string packed(const Body& body) {
  const CheckedMesh& checked = body.mesh;
  const auto& [nodes, elements] = checked.mesh;
  ByteWriter out;
  out.put(body.making).put(body.notes.size());
  for (const std::string& note : body.notes) out.put_list(std::span(note.data(), note.size()));
  out.put(std::array{checked.pieces, checked.flipped, checked.straightened, checked.unused_nodes, checked.duplicates});
  out.put(elements.cols());
  out.put_list(std::span(nodes.data(), static_cast<std::size_t>(nodes.size())));
  out.put_list(std::span(elements.data(), static_cast<std::size_t>(elements.size())));
  return out.bytes();
}

// Checked again, as if it came from anywhere.
std::optional<Body> unpacked(std::string_view bytes) {
  ByteReader in(bytes);
  Body body;
  std::size_t notes = 0;
  if (!in.get(body.making) || text_of(body.making).empty() || !in.get(notes)) return std::nullopt;
  std::vector<char> note;
  for (; notes > 0; --notes) {
    if (!in.get_list(note)) return std::nullopt;
    body.notes.emplace_back(note.begin(), note.end());
  }
  std::array<int, 5> counts{};
  Eigen::Index per_element = 0;
  std::vector<double> nodes;
  std::vector<std::int32_t> elements;
  if (!in.get(counts) || !in.get(per_element) || !in.get_list(nodes) || !in.get_list(elements) || !in.finished()) {
    return std::nullopt;
  }
  const auto node_numbers = static_cast<Eigen::Index>(nodes.size()),
             corners = static_cast<Eigen::Index>(elements.size());
  if (node_numbers % 3 != 0 || per_element < 4 || per_element > corners || corners % per_element != 0) {
    return std::nullopt;
  }
  Result<CheckedMesh> checked =
      check_mesh({.nodes = Eigen::Map<const Points>(nodes.data(), node_numbers / 3, 3),
                  .elements = Eigen::Map<const Indices>(elements.data(), corners / per_element, per_element)},
                 "the cache");
  if (!checked || checked->pieces != counts[0]) return std::nullopt;
  checked->flipped = counts[1];
  checked->straightened = counts[2];
  checked->unused_nodes = counts[3];
  checked->duplicates = counts[4];
  body.mesh = std::move(*checked);
  return body;
}

}  // namespace

Result<Body> make_through_cache(const std::filesystem::path& path, const GmshOptions& options,
                                const ContentCache& cache, const std::function<Result<Body>()>& make) {
  const Result<std::string> text = read_whole_file(path, kMaxFileBytes);
  if (!text || has_companions(path) || (is_program(path) && looks_elsewhere(*text))) return make();
  const ContentHash key = key_of(path, *text, options);
  if (const auto kept = cache.find(kKind, key)) {
    if (auto body = unpacked(*kept)) return std::move(*body);
  }
  Result<Body> body = make();
  if (body) (void)cache.store(kKind, key, packed(*body));  // a cache that cannot be written costs time only
  return body;
}

}  // namespace ringdown::mesh
