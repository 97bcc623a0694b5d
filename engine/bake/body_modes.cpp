#include "engine/bake/body_modes.h"

#include "engine/base/byte_stream.h"
#include "engine/dense/decompositions.h"
#include "engine/fem/heat_flow.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ringdown::bake {

double BodyUnits::shape() const { return 1 / std::sqrt(density_kg_m3 * std::pow(length_m, 3)); }

modal::MassProperties BodyUnits::mass(const modal::MassProperties& body) const {
  modal::MassProperties mass = body;
  const double unit_kg = density_kg_m3 * std::pow(length_m, 3);
  mass.mass_kg = unit_kg * body.mass_kg;
  mass.center_of_mass_m = length_m * body.center_of_mass_m;
  mass.inertia_kg_m2 = unit_kg * length_m * length_m * body.inertia_kg_m2;
  return mass;
}

BodyModes up_to(BodyModes modes, double top) {
  const auto count = std::upper_bound(modes.lambda.begin(), modes.lambda.end(), top) - modes.lambda.begin();
  modes.lambda.conservativeResize(count);
  modes.residuals.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
  if (modes.errors.size() > 0) modes.errors.conservativeResize(count);
  for (Eigen::MatrixXd* share :
       {&modes.shares.strain, &modes.shares.motion, &modes.shares.springs, &modes.shares.points, &modes.heat}) {
    if (share->size() > 0) share->conservativeResize(Eigen::NoChange, count);
  }
  if (modes.wet) {
    for (Eigen::VectorXd* numbers : {&modes.wet->strain, &modes.wet->motion, &modes.wet->drag, &modes.wet->errors})
      numbers->conservativeResize(count);
    modes.wet->free_flow.conservativeResize(Eigen::NoChange, count);
  }
  if (modes.interior) modes.interior->shapes.conservativeResize(Eigen::NoChange, count);
  modes.complete_to = std::min(modes.complete_to, top);
  return modes;
}

double characteristic_length(const mesh::Points& nodes) {
  return (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).norm();
}

namespace {

constexpr std::string_view kModes = "modes", kExpected = "expected";
constexpr int kFormat = 6;  // of an entry; raise it also when assembly, counting or the estimate give other results
constexpr double kGrid = 1 << 24, kGridOffset = 0.3819660113;  // off the halves that structured meshes sit on
constexpr double kSameNode = 1e-13;

void add_elements(ContentHasher& hasher, const mesh::TetMesh& mesh) {
  hasher.value(kFormat).value(mesh.nodes.rows()).value(mesh.elements.cols());
  hasher.values(std::span(mesh.elements.data(), static_cast<std::size_t>(mesh.elements.size())));
}

ContentHash key_of(const BodyQuestion& question) {
  ContentHasher hasher;
  add_elements(hasher, question.unit_mesh);
  std::vector<std::int64_t> grid;
  grid.reserve(static_cast<std::size_t>(question.unit_mesh.nodes.size()));
  for (const double x : question.unit_mesh.nodes.reshaped<Eigen::RowMajor>()) {
    grid.push_back(std::llround(kGrid * x + kGridOffset));
  }
  hasher.values(std::span<const std::int64_t>(grid)).text(fem::element_name(question.element));
  hasher.value(question.poisson_ratio).value(question.tolerance);
  if (!question.makeup.empty()) hasher.text(question.makeup);
  return hasher.hash();
}

ContentHash family_key(const BodyQuestion& question, const std::string& family) {
  ContentHasher hasher;
  if (family.empty()) add_elements(hasher, question.unit_mesh);
  return hasher.text(family).hash();
}

template <class Matrix>
std::span<const double> numbers(const Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

std::string packed(const mesh::Points& nodes, const BodyModes& modes) {
  ByteWriter out;
  out.put_list(numbers(nodes)).put_list(numbers(modes.lambda)).put_list(numbers(modes.shapes));
  out.put_list(numbers(modes.residuals)).put_list(numbers(modes.errors));
  out.put(modes.complete_to).put(modes.rigid).put(static_cast<int>(modes.verified)).put(modes.unknowns).put(modes.mass);
  out.put_list(numbers(modes.heat));
  if (modes.shares.strain.size() > 0) {
    out.put(static_cast<std::uint64_t>(modes.shares.strain.rows())).put_list(numbers(modes.shares.strain));
    out.put_list(numbers(modes.shares.motion)).put_list(numbers(modes.shares.springs));
    out.put_list(numbers(modes.shares.points));
  }
  return out.bytes();
}

bool is_ascending_above_zero(const std::vector<double>& lambda) {
  double last = 0;
  for (const double value : lambda) {
    if (!(value > 0 && value >= last && std::isfinite(value))) return false;
    last = value;
  }
  return true;
}

bool same_nodes(const std::vector<double>& kept, const mesh::Points& nodes) {
  if (kept.size() != static_cast<std::size_t>(nodes.size())) return false;
  const double off = (Eigen::Map<const mesh::Points>(kept.data(), nodes.rows(), 3) - nodes).cwiseAbs().maxCoeff();
  return off <= kSameNode * std::max(1.0, nodes.cwiseAbs().maxCoeff());  // false also for NaN
}

// The shares of `modes` modes at the end of an entry, which a plain body's does not have.
bool read_shares(ByteReader& in, std::size_t modes, ModeShares& shares) {
  if (in.finished()) return true;
  std::uint64_t parts = 0;
  std::vector<double> strain, motion, springs, points;
  if (!in.get(parts) || !in.get_list(strain) || !in.get_list(motion) || !in.get_list(springs) || !in.get_list(points))
    return false;
  const bool whole = parts > 0 && modes > 0 && strain.size() == parts * modes && motion.size() == strain.size() &&
                     springs.size() % (2 * modes) == 0 && points.size() % modes == 0;
  if (!whole) return false;
  const auto matrix = [modes](const std::vector<double>& list) {
    const auto columns = static_cast<Eigen::Index>(modes);
    return Eigen::MatrixXd(
        Eigen::Map<const Eigen::MatrixXd>(list.data(), static_cast<Eigen::Index>(list.size()) / columns, columns));
  };
  shares = {matrix(strain), matrix(motion), matrix(springs), matrix(points)};
  return shares.strain.allFinite() && shares.motion.allFinite() && shares.springs.allFinite() &&
         shares.points.allFinite();
}

std::optional<BodyModes> unpacked(std::string_view bytes, const BodyQuestion& question) {
  ByteReader in(bytes);
  std::vector<double> nodes, lambda, shapes, residuals, errors, heat;
  BodyModes modes;
  int verified = 0;
  if (!in.get_list(nodes) || !in.get_list(lambda) || !in.get_list(shapes) || !in.get_list(residuals) ||
      !in.get_list(errors) || !in.get(modes.complete_to) || !in.get(modes.rigid) || !in.get(verified) ||
      !in.get(modes.unknowns) || !in.get(modes.mass) || !in.get_list(heat) ||
      !read_shares(in, lambda.size(), modes.shares) || !in.finished()) {
    return std::nullopt;
  }
  const std::size_t rows = 3 * question.surface_nodes, count = lambda.size(), pairs = 2 * fem::kHeatPairs;
  const bool whole = shapes.size() == rows * count && residuals.size() == count &&
                     (errors.empty() || errors.size() == count) && (heat.empty() || heat.size() == pairs * count) &&
                     is_ascending_above_zero(lambda);
  const bool has_shares = modes.shares.strain.size() > 0;
  if (!whole || has_shares == (question.makeup.empty() || count == 0)) return std::nullopt;
  if (!same_nodes(nodes, question.unit_mesh.nodes)) return std::nullopt;
  const auto vector = [](const std::vector<double>& list) {
    return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
  };
  modes.verified = verified != 0;
  modes.lambda = vector(lambda);
  modes.residuals = vector(residuals);
  modes.errors = vector(errors);
  modes.shapes = Eigen::Map<const Eigen::MatrixXd>(shapes.data(), static_cast<Eigen::Index>(rows),
                                                   static_cast<Eigen::Index>(count));
  if (!heat.empty())
    modes.heat = Eigen::Map<const Eigen::MatrixXd>(heat.data(), static_cast<Eigen::Index>(pairs),
                                                   static_cast<Eigen::Index>(count));
  if (!modes.shapes.allFinite() || !modes.heat.allFinite()) return std::nullopt;
  return modes;
}

}  // namespace

std::optional<BodyModes> ModeCache::find(const BodyQuestion& question, double top, int max_modes) const {
  const auto kept = cache_.find(kModes, key_of(question));
  if (!kept) return std::nullopt;
  auto modes = unpacked(*kept, question);
  if (!modes || !(modes->complete_to >= top)) return std::nullopt;
  modes = up_to(std::move(*modes), top);
  if (modes->lambda.size() > max_modes) return std::nullopt;
  return modes;
}

Result<void> ModeCache::store(const BodyQuestion& question, const BodyModes& modes) const {
  return cache_.store(kModes, key_of(question), packed(question.unit_mesh.nodes, modes));
}

Eigen::VectorXd ModeCache::expected(const BodyQuestion& question, const std::string& family) const {
  const auto kept = cache_.find(kExpected, family_key(question, family));
  std::vector<double> lambda;
  if (!kept) return {};
  ByteReader in(*kept);
  if (!in.get_list(lambda) || !in.finished() || !is_ascending_above_zero(lambda)) return {};
  return Eigen::Map<const Eigen::VectorXd>(lambda.data(), static_cast<Eigen::Index>(lambda.size()));
}

Result<void> ModeCache::expect(const BodyQuestion& question, const std::string& family,
                               const Eigen::VectorXd& lambda) const {
  return cache_.store(kExpected, family_key(question, family), ByteWriter().put_list(numbers(lambda)).bytes());
}

namespace {

// Columns: the principal axes, each with its largest component positive, the last chosen to make the frame
// right-handed.
Eigen::Matrix3d principal_frame(const Eigen::Matrix3d& axes) {
  Eigen::Matrix3d frame = axes;
  for (int k = 0; k < 2; ++k) {
    Eigen::Index largest = 0;
    frame.col(k).cwiseAbs().maxCoeff(&largest);
    if (frame(largest, k) < 0) frame.col(k) *= -1;
  }
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

modal::MassProperties mass_properties(const mesh::TetMesh& mesh, const fem::SparseMatrix& node_mass) {
  const Eigen::VectorXd weight = node_mass * Eigen::VectorXd::Ones(node_mass.cols());
  const double mass = weight.sum();
  const Eigen::RowVector3d center = weight.transpose() * mesh.nodes / mass;
  const Eigen::MatrixXd arm = mesh.nodes.rowwise() - center;
  const Eigen::Matrix3d second = arm.transpose() * (node_mass * arm);
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  const dense::Spectrum3 principal = dense::spectrum_of_3(inertia);
  const Eigen::Vector3d& moments = principal.values;
  const Eigen::Quaterniond turn(principal_frame(principal.vectors));
  return {.mass_kg = mass,
          .center_of_mass_m = {center[0], center[1], center[2]},
          .inertia_kg_m2 = {moments[0], moments[1], moments[2]},
          .orientation = {turn.x(), turn.y(), turn.z(), turn.w()}};
}

}  // namespace ringdown::bake
