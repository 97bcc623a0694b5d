#include "engine/mesh/body.h"

#include "engine/base/byte_stream.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/face_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::mesh {
namespace {

constexpr std::uint64_t kMaxTexts = 1000, kMaxText = 4000;  // bytes of one
constexpr std::uint64_t kMaxParameters = 1000;

void put(ByteWriter& out, const std::string& text) { out.put_list(std::span(text.data(), text.size())); }

// Refuses texts with control characters, which could manipulate a terminal.
bool get(ByteReader& in, std::string& text) {
  std::vector<char> bytes;
  if (!in.get_list(bytes) || bytes.size() > kMaxText) return false;
  text.assign(bytes.begin(), bytes.end());
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return true;
}

void put(ByteWriter& out, const std::vector<std::string>& texts) {
  const std::size_t count = std::min<std::size_t>(texts.size(), kMaxTexts);
  out.put(std::uint64_t{count});
  for (std::size_t i = 0; i < count; ++i) put(out, texts[i].substr(0, kMaxText));
}

bool get(ByteReader& in, std::vector<std::string>& texts) {
  std::uint64_t count = 0;
  if (!in.get(count) || count > kMaxTexts) return false;
  texts.resize(count);
  return std::all_of(texts.begin(), texts.end(), [&in](std::string& text) { return get(in, text); });
}

bool get_finite(ByteReader& in, double& number) { return in.get(number) && std::isfinite(number); }

// Writes the number of columns, then the matrix row by row.
template <class Matrix>
void put_matrix(ByteWriter& out, const Matrix& matrix) {
  out.put(std::int64_t{matrix.cols()});
  out.put_list(std::span(matrix.data(), static_cast<std::size_t>(matrix.size())));
}

template <class Matrix>
bool get_matrix(ByteReader& in, Matrix& matrix, std::int64_t min_columns, std::int64_t max_columns) {
  using Number = typename Matrix::Scalar;
  std::int64_t columns = 0;
  std::vector<Number> numbers;
  if (!in.get(columns) || columns < min_columns || columns > max_columns || !in.get_list(numbers)) return false;
  const auto count = static_cast<std::int64_t>(numbers.size());
  if (count % columns != 0) return false;
  matrix = Eigen::Map<const Matrix>(numbers.data(), count / columns, columns);
  return true;
}

void put(ByteWriter& out, const TriangleMesh& mesh) {
  put_matrix(out, mesh.nodes);
  put_matrix(out, mesh.triangles);
}

bool get(ByteReader& in, TriangleMesh& mesh) {
  if (!get_matrix(in, mesh.nodes, 3, 3) || !get_matrix(in, mesh.triangles, 3, 3)) return false;
  if (mesh.nodes.rows() == 0 || mesh.triangles.rows() == 0 || !mesh.nodes.allFinite()) return false;
  return mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.nodes.rows();
}

void put(ByteWriter& out, const Finding& finding) {
  out.put(finding.fault).put(std::uint64_t{finding.count}).put(finding.length_m);
  out.put(std::uint64_t{finding.places.size()});
  for (const Eigen::RowVector3d& at : finding.places) out.put(at[0]).put(at[1]).put(at[2]);
  out.put_list(std::span<const std::int32_t>(finding.triangles));
}

bool get(ByteReader& in, Finding& finding) {
  std::uint64_t count = 0, places = 0;
  if (!in.get(finding.fault) || finding.fault < Fault{} || finding.fault > Fault::kNoVolume) return false;
  if (!in.get(count) || !get_finite(in, finding.length_m) || !in.get(places) || places > kMaxPlaces) return false;
  finding.count = count;
  finding.places.resize(places);
  for (Eigen::RowVector3d& at : finding.places) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!get_finite(in, at[axis])) return false;
    }
  }
  return in.get_list(finding.triangles) && finding.triangles.size() <= kMaxPlaces;
}

void put(ByteWriter& out, const SurfaceReport& report) {
  out.put(std::int32_t{report.shells}).put(report.volume_m3).put(report.area_m2).put(report.diagonal_m);
  out.put(std::uint64_t{report.findings.size()});
  for (const Finding& finding : report.findings) put(out, finding);
}

bool get(ByteReader& in, SurfaceReport& report) {
  constexpr std::uint64_t kFaults = static_cast<std::uint64_t>(Fault::kNoVolume) + 1;
  std::uint64_t findings = 0;
  if (!in.get(report.shells) || !get_finite(in, report.volume_m3) || !get_finite(in, report.area_m2)) return false;
  if (!get_finite(in, report.diagonal_m) || !in.get(findings) || findings > kFaults) return false;
  report.findings.resize(findings, Finding{.fault = Fault::kNoVolume});
  return std::all_of(report.findings.begin(), report.findings.end(),
                     [&in](Finding& finding) { return get(in, finding); });
}

void put(ByteWriter& out, const MeshGroups& groups) {
  put(out, groups.volumes);
  out.put_list(std::span<const std::int32_t>(groups.volume_of));
  out.put(std::uint64_t{groups.surfaces.size()});
  for (const FaceGroup& group : groups.surfaces) {
    put(out, group.name);
    out.put_list(std::span<const std::int64_t>(group.faces));
  }
}

bool get(ByteReader& in, MeshGroups& groups, Eigen::Index elements) {
  std::uint64_t surfaces = 0;
  if (!get(in, groups.volumes) || !in.get_list(groups.volume_of) || !in.get(surfaces) || surfaces > kMaxPlaces * 100)
    return false;
  const auto count = static_cast<std::int32_t>(groups.volumes.size());
  const auto known = [count](std::int32_t volume) { return volume >= -1 && volume < count; };
  if (groups.volume_of.size() != (count > 0 ? static_cast<std::size_t>(elements) : 0)) return false;
  if (!std::all_of(groups.volume_of.begin(), groups.volume_of.end(), known)) return false;
  groups.surfaces.resize(surfaces);
  return std::all_of(groups.surfaces.begin(), groups.surfaces.end(), [&](FaceGroup& group) {
    if (!get(in, group.name) || !in.get_list(group.faces)) return false;
    return std::is_sorted(group.faces.begin(), group.faces.end()) &&
           (group.faces.empty() || (group.faces.front() >= 0 && group.faces.back() < 4 * elements));
  });
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
    case Making::kRefilled:
      return "skin of a stuffed surface filled by gmsh";
  }
  return "";
}

std::string packed(Question question, const GmshOptions& options) {
  const auto& [unit_m, mesh_size_m, edge_size_m, order, force_coarse, cavities, quick, wall_scale, parameters, parts] =
      options;
  ByteWriter out;
  out.put(question)
      .put(std::int32_t{unit_m.has_value()})
      .put(unit_m.value_or(0))
      .put(mesh_size_m)
      .put(edge_size_m)
      .put(order)
      .put(std::int32_t{force_coarse})
      .put(std::int32_t{cavities})
      .put(std::int32_t{quick})
      .put(wall_scale);
  out.put(std::uint64_t{parameters.size()});
  for (const auto& [name, value] : parameters) {
    put(out, name);
    out.put(value);
  }
  put(out, parts);
  return out.bytes();
}

bool unpack_question(std::string_view bytes, Question& question, GmshOptions& options) {
  ByteReader in(bytes);
  std::int32_t has_unit = 0, force_coarse = 0, cavities = 0, quick = 0;
  double unit_m = 0;
  std::uint64_t parameters = 0;
  if (!in.get(question) || !in.get(has_unit) || !in.get(unit_m) || !in.get(options.mesh_size_m)) return false;
  if (!in.get(options.edge_size_m) || !in.get(options.order) || !in.get(force_coarse)) return false;
  if (!in.get(cavities) || !in.get(quick) || !in.get(options.wall_scale) || !in.get(parameters)) return false;
  if (parameters > kMaxParameters) return false;
  options.unit_m = has_unit != 0 ? std::optional(unit_m) : std::nullopt;
  options.force_coarse = force_coarse != 0;
  options.cavities = cavities != 0;
  options.quick = quick != 0;
  options.parameters.clear();
  for (; parameters > 0; --parameters) {
    std::string name;
    if (!get(in, name) || !in.get(options.parameters[name])) return false;
  }
  return get(in, options.parts) && in.finished();
}

std::string packed(const Body& body) {
  const CheckedMesh& checked = body.mesh;
  ByteWriter out;
  out.put(body.making).put(body.wall_elements);
  put(out, body.notes);
  out.put(std::array{checked.pieces, checked.flipped, checked.straightened, checked.unused_nodes, checked.duplicates});
  put_matrix(out, checked.mesh.nodes);
  put_matrix(out, checked.mesh.elements);
  out.put_list(std::span(checked.gaps_m.data(), static_cast<std::size_t>(checked.gaps_m.size())));
  put(out, checked.groups);
  return out.bytes();
}

bool unpack(std::string_view bytes, Body& body) {
  ByteReader in(bytes);
  std::array<int, 5> counts{};
  TetMesh mesh;
  if (!in.get(body.making) || text_of(body.making).empty() || !get_finite(in, body.wall_elements)) return false;
  if (body.wall_elements < 0 || !get(in, body.notes) || !in.get(counts)) return false;
  if (!get_matrix(in, mesh.nodes, 3, 3) || !get_matrix(in, mesh.elements, 4, nodes_per_element(kMaxOrder)))
    return false;
  std::vector<double> gaps_m;
  MeshGroups groups;
  if (!in.get_list(gaps_m) || !get(in, groups, mesh.elements.rows()) || !in.finished()) return false;
  Result<CheckedMesh> checked = check_mesh(std::move(mesh), "the body");
  if (!checked || checked->pieces != counts[0]) return false;
  checked->gaps_m = Eigen::Map<const Eigen::VectorXd>(gaps_m.data(), static_cast<Eigen::Index>(gaps_m.size()));
  const std::size_t points = kPointsPerFace * outer_faces(checked->mesh.elements).size();
  if (!gaps_m.empty() && (gaps_m.size() != points || !checked->gaps_m.allFinite())) return false;
  if (!groups.empty() && checked->duplicates > 0) return false;  // the groups' element numbers would no longer match
  checked->groups = std::move(groups);
  checked->flipped = counts[1];
  checked->straightened = counts[2];
  checked->unused_nodes = counts[3];
  checked->duplicates = counts[4];
  body.mesh = std::move(*checked);
  return true;
}

std::string packed(const Sketch& sketch) {
  ByteWriter out;
  put(out, sketch.skin);
  out.put(sketch.wall_m);
  out.put(static_cast<std::int32_t>(sketch.sized_by_file));
  return out.bytes();
}

bool unpack(std::string_view bytes, Sketch& sketch) {
  ByteReader in(bytes);
  std::int32_t sized_by_file = 0;
  const bool good = get(in, sketch.skin) && get_finite(in, sketch.wall_m) && sketch.wall_m >= 0 &&
                    in.get(sized_by_file) && (sized_by_file == 0 || sized_by_file == 1) && in.finished();
  sketch.sized_by_file = sized_by_file == 1;
  return good;
}

std::string packed(const PreparedSurface& surface) {
  ByteWriter out;
  put(out, surface.mesh);
  put(out, surface.found);
  put(out, surface.left);
  put(out, surface.actions);
  put(out, surface.notes);
  return out.bytes();
}

bool unpack(std::string_view bytes, PreparedSurface& surface) {
  ByteReader in(bytes);
  return get(in, surface.mesh) && get(in, surface.found) && get(in, surface.left) && get(in, surface.actions) &&
         get(in, surface.notes) && in.finished();
}

std::string packed(const Error& error) {
  ByteWriter out;
  out.put(error.kind);
  put(out, error.message.substr(0, kMaxText));
  return out.bytes();
}

bool unpack(std::string_view bytes, Error& error) {
  constexpr std::array kKinds = {ErrorKind::bad_input, ErrorKind::too_large, ErrorKind::refused, ErrorKind::no_memory,
                                 ErrorKind::input_output};
  ByteReader in(bytes);
  if (!in.get(error.kind) || !get(in, error.message) || error.message.empty()) return false;
  return std::find(kKinds.begin(), kKinds.end(), error.kind) != kKinds.end() && in.finished();
}

}  // namespace ringdown::mesh
