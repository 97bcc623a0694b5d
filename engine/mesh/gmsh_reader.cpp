#include "engine/mesh/gmsh_reader.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/mesh/cone_tips.h"
#include "engine/mesh/face_points.h"
#include "engine/mesh/files/file_kinds.h"
#include "engine/mesh/files/geo_language.h"
#include "engine/mesh/gmsh_groups.h"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sys/mman.h>
#include <unistd.h>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

constexpr double kShareOfBox = 0.01;      // assumed minimum share of its box that a body fills; thin bodies fill little
constexpr double kElementsPerCube = 8.5;  // regular tetrahedra of edge h in a cube of edge h
constexpr double kTrianglesPerSquare = 2.3;
constexpr int kMaxUnfolded = 3;  // highest order; see unfold()

std::string plain_number(double value) { return formatted("{:.17g}", value); }

// A .geo file, in memory only, that sets the parameters and includes the real file. gmsh's own option, -setnumber,
// cannot be undone, and the parser's variables outlive finalize(), so this file also deletes the previous file's.
class ParameterFile {
 public:
  ParameterFile(const std::filesystem::path& geometry, const std::map<std::string, double>& numbers)
      : descriptor_(::memfd_create("parameters", MFD_CLOEXEC)) {
    std::string text = "Delete Variables;\n";
    for (const auto& [name, value] : numbers) text += name + " = " + plain_number(value) + ";\n";
    text += "Include \"" + std::filesystem::absolute(geometry).string() + "\";\n";
    written_ = ::write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  }
  ~ParameterFile() { ::close(descriptor_); }
  ParameterFile(const ParameterFile&) = delete;
  ParameterFile& operator=(const ParameterFile&) = delete;

  [[nodiscard]] bool written() const { return written_; }
  [[nodiscard]] std::string path() const { return formatted("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
  bool written_ = false;
};

bool has_size_fields(const std::filesystem::path& path) {
  if (!is_of_kind(path, FileKind::program)) return false;
  const Result<std::string> text = read_whole_file(path, kMaxGeoBytes);
  if (!text) return false;
  const std::vector<GeoWord> words = words_of_geo(*text);
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i - 1].word == "Background" && words[i].word == "Field") return true;
  }
  return false;
}

Result<void> check_parameters(const std::filesystem::path& path, const std::map<std::string, double>& parameters) {
  if (parameters.empty()) return {};
  if (!is_of_kind(path, FileKind::program)) {
    return fail(ErrorKind::bad_input, path.string() + " takes no parameters; only .geo files have them");
  }
  const Result<std::string> text = read_whole_file(path, kMaxGeoBytes);
  if (!text) return fail(text);
  for (const auto& [name, value] : parameters) {
    if (!assigns(*text, name)) {
      return fail(ErrorKind::bad_input, "{} has no parameter '{}'; the file's DefineConstant lists its parameters",
                  path.string(), name);
    }
  }
  return {};
}

// Returns OpenCASCADE's exact volume of the open body in the file's unit; 0 for gmsh's own kernel, which has none.
double volume_of_open_body() {
  gmsh::vectorpair volumes;
  gmsh::model::occ::getEntities(volumes, 3);
  double volume = 0;
  for (const auto& [dimension, tag] : volumes) {
    double part = 0;
    gmsh::model::occ::getMass(dimension, tag, part);
    volume += std::abs(part);
  }
  return volume;
}

Extent extent_of_open_body(double unit_m) {
  double x0, y0, z0, x1, y1, z1;
  gmsh::model::getBoundingBox(-1, -1, x0, y0, z0, x1, y1, z1);
  const double x = x1 - x0, y = y1 - y0, z = z1 - z0;
  double volume = volume_of_open_body();
  if (!(volume > 0)) volume = kShareOfBox * x * y * z;
  return {.volume_m3 = std::pow(unit_m, 3) * volume, .diagonal_m = unit_m * std::hypot(x, y, z)};
}

// Returns true if the open file has volumes that are not meshed yet.
bool is_geometry() {
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, 3);
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  return types.empty() && !volumes.empty();
}

// Returns true if the two faces meet at more than 20 degrees at the curve's middle. A seam has one face only.
bool is_sharp(int curve) {
  constexpr double kSmooth = 0.94;  // cosine of 20 degrees
  std::vector<int> faces, ends;
  gmsh::model::getAdjacencies(1, curve, faces, ends);
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  if (faces.size() != 2) return faces.size() > 2;
  std::vector<double> from, to, middle;
  gmsh::model::getParametrizationBounds(1, curve, from, to);
  gmsh::model::getValue(1, curve, {0.5 * (from.at(0) + to.at(0))}, middle);
  std::array<std::vector<double>, 2> normals;
  for (int side = 0; side < 2; ++side) {
    std::vector<double> at;
    gmsh::model::getParametrization(2, faces[side], middle, at);
    gmsh::model::getNormal(faces[side], at, normals[side]);
  }
  const auto& [a, b] = normals;
  return std::abs(a.at(0) * b.at(0) + a.at(1) * b.at(1) + a.at(2) * b.at(2)) < kSmooth;
}

std::vector<double> sharp_curves() {
  gmsh::vectorpair curves;
  gmsh::model::getEntities(curves, 1);
  std::vector<double> sharp;
  for (const auto& [dimension, curve] : curves) {
    if (is_sharp(curve)) sharp.push_back(curve);
  }
  return sharp;
}

// Elements of `edge_size` up to half of it away from sharp edges, of `mesh_size` from two and a half on.
void refine_at_edges(double edge_size, double mesh_size) {
  const std::vector<double> curves = sharp_curves();
  if (curves.empty()) return;
  constexpr int kSamples = 400;  // points on each curve
  const int distance = gmsh::model::mesh::field::add("Distance"), size = gmsh::model::mesh::field::add("Threshold");
  gmsh::model::mesh::field::setNumbers(distance, "CurvesList", curves);
  gmsh::model::mesh::field::setNumber(distance, "NumPointsPerCurve", kSamples);
  gmsh::model::mesh::field::setNumber(size, "InField", distance);
  gmsh::model::mesh::field::setNumber(size, "SizeMin", edge_size);
  gmsh::model::mesh::field::setNumber(size, "SizeMax", mesh_size);
  gmsh::model::mesh::field::setNumber(size, "DistMin", 0.5 * edge_size);
  gmsh::model::mesh::field::setNumber(size, "DistMax", 2.5 * edge_size);
  gmsh::model::mesh::field::setAsBackgroundMesh(size);
  gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
}

Result<void> generate(const std::filesystem::path& path, const GmshOptions& options, double unit_m) {
  if (options.mesh_size_m > 0) {
    if (auto few = check_element_count(path, extent_of_open_body(unit_m), options.mesh_size_m); !few) return few;
    gmsh::option::setNumber("Mesh.MeshSizeMax", options.mesh_size_m / unit_m);
    const bool finer_at_edges = options.edge_size_m > 0 && options.edge_size_m < options.mesh_size_m;
    if (finer_at_edges && !has_size_fields(path)) {
      refine_at_edges(options.edge_size_m / unit_m, options.mesh_size_m / unit_m);
    }
  }
  gmsh::model::mesh::generate(3);
  if (options.order > 1) gmsh::model::mesh::setOrder(options.order);
  return {};
}

// One of gmsh's element types: tetrahedra of one order.
struct ElementType {
  int type = 0, order = 0;
  std::vector<int> ours;  // ours[k]: which node of tet_element.h gmsh's node k is
};

// The type of the tetrahedra in a mesh that has no other solid elements.
Result<ElementType> only_type(const std::filesystem::path& path) {
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, 3);
  ElementType found;
  for (const int type : types) {
    std::string name;
    int dimension = 0, order = 0, nodes = 0, primary_nodes = 0;
    std::vector<double> places;
    gmsh::model::mesh::getElementProperties(type, name, dimension, order, nodes, places, primary_nodes);
    if (primary_nodes != 4 || order_of_nodes(nodes) != order) {
      return fail(
          ErrorKind::bad_input,
          "{} has elements of type {}; only tetrahedra of 4, 10, 20 or 35 nodes are understood, so mesh it with those",
          path.string(), name);
    }
    if (found.order > 0) {
      return fail(ErrorKind::bad_input, "{} mixes tetrahedra of {} and of {} nodes; give all of them the same order",
                  path.string(), nodes_per_element(found.order), nodes);
    }
    const Eigen::Map<const Points> free_coordinates(places.data(), nodes, 3);
    Barycentric points(nodes, 4);
    points << (1 - free_coordinates.rowwise().sum().array()).matrix(), free_coordinates;
    found = {type, order, nodes_at(order, points)};
  }
  return found;
}

TetMesh take_mesh(const ElementType& type, double unit_m) {
  std::vector<std::size_t> node_tags, element_tags, element_nodes;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(node_tags, coordinates, parametric);
  gmsh::model::mesh::getElementsByType(type.type, element_tags, element_nodes);

  TetMesh mesh;
  const auto node_count = static_cast<Eigen::Index>(node_tags.size());
  mesh.nodes = unit_m * Eigen::Map<const Points>(coordinates.data(), node_count, 3);
  std::unordered_map<std::size_t, std::int32_t> number;
  for (std::size_t i = 0; i < node_tags.size(); ++i) number.emplace(node_tags[i], static_cast<std::int32_t>(i));
  mesh.elements.resize(static_cast<Eigen::Index>(element_tags.size()), nodes_per_element(type.order));
  std::size_t next = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    for (const int node : type.ours) mesh.elements(e, node) = number.at(element_nodes[next++]);
  }
  return mesh;
}

// gmsh's message as part of a sentence: one line, without a full stop.
std::string clause_of(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "it gave no reason" : text;
}

tl::unexpected<Error> gmsh_failed(const std::filesystem::path& path, const std::string& message) {
  return fail(ErrorKind::bad_input, "gmsh cannot make a mesh of {}: {}", path.string(), clause_of(message));
}

bool has_partitions() {
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  return std::ranges::any_of(volumes, [](const auto& volume) {
    std::string type;
    gmsh::model::getType(3, volume.second, type);
    return type.starts_with("Partition");
  });
}

Result<void> open_file(const std::filesystem::path& path, const GmshOptions& options, double unit_m) {
  const FileFormat* format = format_of(path);
  // OpenCASCADE's formats are imported by name, because gmsh takes an ending of small and capital letters for its own
  // language.
  if (format && !format->opencascade.empty()) {
    gmsh::model::add(path.stem().string());
    gmsh::vectorpair shapes;
    gmsh::model::occ::importShapes(path.string(), shapes, false, std::string(format->opencascade));
    gmsh::model::occ::synchronize();
    return {};
  }
  if (!is_of_kind(path, FileKind::program)) {
    if (format && format->known_to_gmsh && !gmsh_knows_ending(path)) {
      return fail(ErrorKind::bad_input, "gmsh knows the ending of " + path.string() +
                                            " in small or in capital letters only; rename the file");
    }
    // The border of a partition is not needed, and gmsh 4.8 fails on it in old files without a mesh of the surface.
    gmsh::option::setNumber("Mesh.PartitionCreateTopology", 0);
    gmsh::open(path.string());
    if (has_partitions()) gmsh::model::mesh::unpartition();
    return {};
  }
  std::map<std::string, double> numbers = options.parameters;
  if (options.mesh_size_m > 0) numbers[kMeshSizeName] = options.mesh_size_m / unit_m;
  const ParameterFile wrapper(path, numbers);
  if (!wrapper.written())
    return fail(ErrorKind::no_memory, "there is no memory for the parameters of " + path.string());
  gmsh::open(wrapper.path());
  return {};
}

// Moves inner nodes of folded curved elements and of their neighbours until the elements no longer fold. May take
// seconds, and may fail. A bell of 1,259 elements takes 0.5 s at order 2, where 3 elements fold, and 4 s at order 3,
// where 8 fold (with gmsh's own limits 5 and 20 s); at order 4 it would take a minute.
void unfold() {
  gmsh::option::setNumber("Mesh.HighOrderThresholdMin", 0.02);
  gmsh::option::setNumber("Mesh.HighOrderNumLayers", 1);
  gmsh::option::setNumber("Mesh.HighOrderPassMax", 3);
  gmsh::option::setNumber("Mesh.HighOrderIterMax", 20);
  try {
    gmsh::model::mesh::optimize("HighOrder");
  } catch (...) {  // gmsh failed and left the mesh unchanged
  }
}

Result<CheckedMesh> take_open(const std::filesystem::path& path, double unit_m, bool meshed_here) {
  const Result<ElementType> type = only_type(path);
  if (!type) return fail(type);
  if (type->order == 0) return check_mesh({Points(0, 3), Indices(0, 4)}, path.string());
  const auto checked_with_groups = [&] {
    Result<CheckedMesh> checked = check_mesh(take_mesh(*type, unit_m), path.string());
    if (checked) checked->groups = groups_of_open_model(type->type, *checked);
    return checked;
  };
  Result<CheckedMesh> mesh = checked_with_groups();
  if (!meshed_here || !mesh || mesh->straightened == 0 || type->order > kMaxUnfolded) return mesh;
  unfold();
  Result<CheckedMesh> unfolded = checked_with_groups();
  return unfolded && unfolded->straightened < mesh->straightened ? std::move(unfolded) : std::move(mesh);
}

// Meshes that lose volume
//
// Curved elements have their nodes on the geometry and follow it well in between, unless they are so large beside a
// bend that they fold. Folded elements become straight, or gmsh moves their outer nodes to unfold them. Either may lose
// a percent of the volume, and as much of the frequencies. So the volume is compared with that of the geometry, and if
// too much is lost, bends get smaller elements. The loss that the best of these meshes still has is spread evenly over
// the skin, as a gap that the estimated errors of the frequencies then include.
constexpr double kMaxLoss = 2e-3;                 // largest accepted loss or gain, as a share of the volume
constexpr std::array kElementsAround = {10, 16};  // elements around a circle, in the second and the third mesh
constexpr double kMinAtBends = 0.25;              // smallest elements at bends, as a share of the mesh size

struct Loss {
  double volume_m3 = 0;  // volume missing from the mesh; negative if the mesh has more than the geometry
  bool much = false;
};

// Returns no loss for straight elements, whose volume error is expected, and if the exact volume is unknown.
Loss loss_of(const CheckedMesh& checked, double exact_m3) {
  if (!(exact_m3 > 0) || checked.mesh.elements.rows() == 0 || checked.mesh.order() == 1) return {};
  const double lost = exact_m3 - volume_of(checked.mesh);
  return {lost, std::abs(lost) > kMaxLoss * exact_m3};
}

Result<CheckedMesh> mesh_bends_finer(const std::filesystem::path& path, const GmshOptions& options, double unit_m,
                                     double exact_m3, Result<CheckedMesh> best) {
  for (const int around : kElementsAround) {
    gmsh::model::mesh::clear();
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", around);
    if (options.mesh_size_m > 0) {
      gmsh::option::setNumber("Mesh.MeshSizeMin", kMinAtBends * options.mesh_size_m / unit_m);
    }
    if (auto meshed = generate(path, options, unit_m); !meshed) return best;
    Result<CheckedMesh> finer = take_open(path, unit_m, true);
    if (!finer) continue;
    const bool better = std::abs(loss_of(*finer, exact_m3).volume_m3) < std::abs(loss_of(*best, exact_m3).volume_m3);
    if (better) best = std::move(finer);
    if (!loss_of(*best, exact_m3).much) return best;
  }
  const FacePoints skin = face_points(best->mesh);
  const double gap_m = loss_of(*best, exact_m3).volume_m3 / skin.areas.sum();
  best->gaps_m = Eigen::VectorXd::Constant(skin.areas.size(), gap_m);
  return best;
}

Result<CheckedMesh> read_open(const std::filesystem::path& path, const GmshOptions& options) {
  const double unit_m = options.unit_m ? *options.unit_m : unit_in_file(path);
  const GmshSession session;
  gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
  Result<CheckedMesh> mesh;
  try {
    if (auto opened = open_file(path, options, unit_m); !opened) return fail(opened);
    if (const auto error = session.first_error()) return gmsh_failed(path, *error);
    const bool meshed_here = is_geometry();
    if (meshed_here) {
      cut_cone_tips();
      if (auto meshed = generate(path, options, unit_m); !meshed) return fail(meshed);
    }
    if (const auto error = session.first_error()) return gmsh_failed(path, *error);
    mesh = take_open(path, unit_m, meshed_here);
    const double exact_m3 = meshed_here ? std::pow(unit_m, 3) * volume_of_open_body() : 0;
    if (mesh && loss_of(*mesh, exact_m3).much)
      return mesh_bends_finer(path, options, unit_m, exact_m3, std::move(mesh));
    return mesh;
  } catch (...) {  // gmsh throws several types; the log has the message, too
    return gmsh_failed(path, session.first_error().value_or(""));
  }
}

// Opens the file with this value of mesh_size, or with its own value if that is 0, and meshes its curves.
Result<std::vector<double>> nodes_on_curves(const std::filesystem::path& path, const GmshOptions& options,
                                            double mesh_size_m) {
  const double unit_m = options.unit_m ? *options.unit_m : unit_in_file(path);
  const GmshSession session;
  gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
  GmshOptions sized = options;
  sized.mesh_size_m = mesh_size_m;
  std::vector<std::size_t> tags;
  std::vector<double> coordinates, parametric;
  try {
    if (auto opened = open_file(path, sized, unit_m); !opened) return fail(opened);
    if (const auto error = session.first_error()) return gmsh_failed(path, *error);
    gmsh::model::mesh::generate(1);
    gmsh::model::mesh::getNodes(tags, coordinates, parametric);
    return coordinates;
  } catch (...) {
    return gmsh_failed(path, session.first_error().value_or(""));
  }
}

}  // namespace

bool depends_on_mesh_size(const std::filesystem::path& path, const GmshOptions& options, double length_m) {
  constexpr std::array kShares = {1.0 / 12, 1.0 / 40};  // mesh sizes as shares of the body's length
  const Result<std::vector<double>> own = nodes_on_curves(path, options, 0);
  return std::ranges::any_of(kShares, [&](double share) {
    const Result<std::vector<double>> other = nodes_on_curves(path, options, share * length_m);
    return !own || !other || *own != *other;
  });
}

Result<void> check_element_count(const std::filesystem::path& path, const Extent& extent, double mesh_size_m) {
  if (!(mesh_size_m > 0)) return {};
  const double per_m = 1 / mesh_size_m;
  const double elements = kElementsPerCube * extent.volume_m3 * per_m * per_m * per_m +
                          kTrianglesPerSquare * extent.area_m2 * per_m * per_m;
  if (elements <= kMaxElements) return {};
  return fail(ErrorKind::too_large,
              "{}: a mesh size of {:.3g} m is far too small for a body {:.3g} m long: it means about {:.1e} elements, "
              "more than {:.0e}; choose a larger one, or check the unit of its lengths",
              path.string(), mesh_size_m, extent.diagonal_m, elements, kMaxElements);
}

Result<CheckedMesh> read_with_gmsh(const std::filesystem::path& path, const GmshOptions& options) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fail(ErrorKind::bad_input, "cannot open " + path.string() + ": there is no such file");
  }
  if (options.unit_m && (!(*options.unit_m > 0) || !std::isfinite(*options.unit_m))) {
    return fail(ErrorKind::bad_input, "the unit of " + path.string() + " must be a positive length in metres");
  }
  if (auto harmless = check_geo(path); !harmless) return fail(harmless);
  if (auto known = check_parameters(path, options.parameters); !known) return fail(known);
  try {
    return read_open(path, options);
  } catch (const std::exception& exception) {
    return gmsh_failed(path, exception.what());
  }
}

namespace {

std::mutex& only_one() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

GmshSession::GmshSession() : lock_(only_one()) {
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
  gmsh::option::setNumber("General.AbortOnError", 0);  // an exception through its parser spoils the next file
  gmsh::logger::start();
}

GmshSession::~GmshSession() {
  gmsh::logger::stop();  // otherwise the next session would find this session's errors
  gmsh::finalize();
}

std::optional<std::string> GmshSession::first_error() const {
  std::vector<std::string> log;
  gmsh::logger::get(log);
  for (const std::string& line : log) {
    if (line.starts_with("Error")) return line.substr(std::min(line.find(": ") + 2, line.size()));
  }
  return std::nullopt;
}

}  // namespace ringdown::mesh
