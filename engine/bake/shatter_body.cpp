#include "engine/bake/shatter_body.h"

#include "engine/base/in_parallel.h"
#include "engine/base/rotation.h"
#include "engine/dense/blas_threads.h"
#include "engine/fem/surface_stress.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/face_points.h"
#include "engine/shatter/cut.h"
#include "engine/shatter/pieces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

// The pieces of a body
//
// The body's own elements are cut, so the body's motions are polynomials in every element of a piece, and of its
// degree. A motion of the body is therefore a field of the piece's finite elements, exactly, and its projection on the
// piece's motions is a product of matrices:
//
//   P = [R_s Psi]^T M_s [R_b Phi]
//
// with the mass matrix M_s of the piece, its rigid motions R_s and modes Psi, and those of the body, R_b and Phi, at
// the piece's nodes. A coarser piece takes the body's place where it breaks again. The complete product over all
// motions of all pieces is orthogonal; pieces whose modes end at the band's top take less.
namespace ringdown::bake {
namespace {

Eigen::Vector3d vector_of(Vec3 v) { return {v.x, v.y, v.z}; }

// Rigid motions at the nodes, 3N x 6, orthonormal in the mass of the body that has `mass` (fracture.h).
Eigen::MatrixXd rigid_motions(const mesh::Points& nodes, const modal::MassProperties& mass) {
  const Rotation turn = Rotation::from_xyzw(mass.orientation);
  const std::array<Vec3, 3> axes = {rotated(turn, {1, 0, 0}), rotated(turn, {0, 1, 0}), rotated(turn, {0, 0, 1})};
  const std::array<double, 3> inertia = {mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
  const Eigen::Vector3d centre = vector_of(mass.center_of_mass_m);
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * nodes.rows(), 6);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    const Eigen::Vector3d arm = nodes.row(n).transpose() - centre;
    for (int i = 0; i < 3; ++i) {
      motions(3 * n + i, i) = 1 / std::sqrt(mass.mass_kg);
      motions.block<3, 1>(3 * n, 3 + i) = vector_of(axes[i]).cross(arm) / std::sqrt(inertia[i]);
    }
  }
  return motions;
}

struct Cut {
  const SolvedBody& body;
  const modal::MassProperties& mass;
  shatter::CutBody parts;
};

// A piece that has been baked, with its motions at its nodes.
struct BakedPiece {
  modal::PieceBank bank;
  shatter::PieceMesh mesh;
  SolvedBody solved;
};
using BakedLevel = std::vector<BakedPiece>;

// Returns P of a piece for a whole that has this mass and, at the piece's nodes, these modes.
std::vector<float> handover(const BakedPiece& piece, const modal::MassProperties& whole,
                            const Eigen::MatrixXd& whole_shapes) {
  const SolvedBody& solved = piece.solved;
  const Eigen::Index rigid = modal::kRigidMotions;
  Eigen::MatrixXd own(solved.shapes.rows(), rigid + solved.shapes.cols());
  own << rigid_motions(solved.mesh.nodes, *piece.bank.bank.mass), solved.shapes;
  Eigen::MatrixXd of_whole(solved.shapes.rows(), rigid + whole_shapes.cols());
  of_whole << rigid_motions(solved.mesh.nodes, whole), whole_shapes;
  const Eigen::MatrixXf p = (own.transpose() * fem::mass_times(solved.node_mass, of_whole)).cast<float>();
  std::vector<float> rows;
  rows.reserve(static_cast<std::size_t>(p.size()));
  for (const auto& row : p.rowwise()) rows.insert(rows.end(), row.begin(), row.end());
  return rows;
}

Result<BakedPiece> bake_piece(const Cut& cut, shatter::PieceMesh mesh, const modal::Material& material,
                              const BakeOptions& options, const Vec3& place_m, const std::string& name) {
  Result<Baked> baked = bake({.mesh = mesh.mesh, .pieces = 1}, material, options, name);
  if (!baked) return fail(baked);
  BakedPiece piece{{.bank = std::move(baked->bank)}, std::move(mesh), *std::move(baked->body)};
  piece.bank.handover = handover(piece, cut.mass, shatter::restricted(piece.mesh, cut.body.mesh, cut.body.shapes));
  const Eigen::VectorXd distances = (piece.mesh.mesh.nodes.rowwise() - vector_of(place_m).transpose()).rowwise().norm();
  piece.bank.near_m = distances.minCoeff();
  piece.bank.far_m = distances.maxCoeff();
  return piece;
}

// Notes which coarser piece a piece belongs to, and the projection of that one's motions.
void nest(BakedPiece& piece, const BakedLevel& coarser, std::size_t number) {
  const BakedPiece& whole = coarser[number];
  piece.bank.coarser = number;
  piece.bank.from_coarser =
      handover(piece, *whole.bank.bank.mass, shatter::restricted(piece.mesh, whole.mesh, whole.solved.shapes));
}

// Counts finished pieces over all patterns, for the progress.
struct Work {
  const Progress& progress;
  std::mutex mutex;
  std::size_t done = 0, count = 0;
  std::optional<Error> failure;

  bool go_on(std::size_t finished) {
    const std::scoped_lock lock(mutex);
    done += finished;
    if (failure) return false;
    const double fraction = static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(count, 1));
    if (progress && !progress("pieces", fraction)) failure = Error{ErrorKind::cancelled, "cancelled"};
    return !failure;
  }
  void fail_with(const Error& error) {
    const std::scoped_lock lock(mutex);
    if (!failure) failure = error;
  }
};

// Bakes the pieces of a level; they are nested in those of `coarser` unless that is empty.
Result<BakedLevel> bake_level(const Cut& cut, const shatter::Level& level, const BakedLevel& coarser,
                              const modal::Bank& whole, const BakeOptions& options, const Vec3& place_m, Work& work) {
  std::vector<std::optional<BakedPiece>> baked(level.pieces.size());
  std::atomic<std::size_t> next = 0;
  const auto bake_some = [&](int /*worker*/) {
    for (std::size_t i = next++; i < baked.size() && work.go_on(0); i = next++) {
      shatter::PieceMesh mesh = piece_mesh(cut.parts, cut.body.mesh, elements_of(level, static_cast<std::int32_t>(i)));
      Result<BakedPiece> piece =
          bake_piece(cut, std::move(mesh), *whole.material, options, place_m, formatted("{}.{}", whole.name, i));
      if (!piece) return work.fail_with(piece.error());
      if (!coarser.empty()) nest(*piece, coarser, static_cast<std::size_t>(level.pieces[i].coarser));
      baked[i] = std::move(*piece);
      work.go_on(1);
    }
  };
  in_parallel(thread_count(0), bake_some);
  if (work.failure) return fail(*work.failure);
  BakedLevel pieces;
  for (std::optional<BakedPiece>& piece : baked) pieces.push_back(*std::move(piece));
  return pieces;
}

constexpr Eigen::Index kStressPointsOfPiece = 50;

// The options of a piece, which keeps all its modes and is held by nothing.
BakeOptions options_of_piece(const BakeOptions& of_body, const Shatter& shatter) {
  return {.element = of_body.element,
          .band_low_hz = shatter.band_low_hz,
          .band_high_hz = shatter.band_high_hz,
          .shape_error = of_body.shape_error,
          .air = of_body.air,
          .radiation_error = of_body.radiation_error,
          .solver = of_body.solver == solve::Method::kSlepc ? solve::Method::kAutomatic : of_body.solver,
          .may_be_silent = true,
          .interior = true};
}

Vec3 middle_of_surface(const SolvedBody& body, const modal::MassProperties& mass) {
  const mesh::Boundary surface = mesh::boundary_of(body.mesh);
  const Eigen::RowVector3d centre = vector_of(mass.center_of_mass_m).transpose();
  const auto distance = [&](std::int32_t node) { return (body.mesh.nodes.row(node) - centre).squaredNorm(); };
  const auto nearest = body.mesh.nodes.row(*std::ranges::min_element(surface.nodes, {}, distance));
  return {nearest[0], nearest[1], nearest[2]};
}

// The stress of the body's modes at up to `points` places; the body is of one isotropic material.
modal::StressTable stress_table(const SolvedBody& body, const modal::Material& material,
                                Eigen::Index points = fem::kStressPoints) {
  const fem::SurfaceStress stress = fem::surface_stress(
      body.mesh, fem::Elastic{material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3}, body.shapes,
      points);
  modal::StressTable table;
  for (const auto& at : stress.positions.cast<float>().rowwise()) table.positions.push_back({at[0], at[1], at[2]});
  table.stress.reserve(static_cast<std::size_t>(stress.components.size()));
  for (const auto& row : stress.components.cast<float>().rowwise())
    table.stress.insert(table.stress.end(), row.begin(), row.end());
  for (const double largest : stress.largest) table.largest.push_back(static_cast<float>(largest));
  return table;
}

// When the body breaks, and what its cracks cost. A ductile material says neither.
modal::Fracture strength_of(const SolvedBody& body, const modal::Material& material) {
  modal::Fracture fracture{.stress = stress_table(body, material), .skin_m2 = mesh::face_points(body.mesh).areas.sum()};
  if (!material.brittleness) return fracture;
  fracture.strength = material.brittleness->strength;
  fracture.crack_energy_j_m2 = modal::crack_energy_j_m2(material.brittleness->toughness_pa_sqrt_m,
                                                        material.youngs_modulus_pa, material.poisson_ratio);
  return fracture;
}

// Adds all that pieces need in order to break again: the area of their skins and of the cracks inside them, and the
// stress of their modes.
void add_second_breaks(BakedLevel& pieces, const shatter::Level& level, const modal::Material& material) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    auto& [bank, mesh, solved] = pieces[i];
    bank.crack_area_m2 = level.pieces[i].crack_area_m2;
    if (bank.crack_area_m2 == 0 || bank.bank.mode_count() == 0) continue;  // it breaks no more
    bank.skin_m2 = mesh::face_points(solved.mesh).areas.sum();
    bank.stress = stress_table(solved, material, kStressPointsOfPiece);
  }
}

// More pieces than a bank's file may have (fracture.h) are refused before they are baked.
Result<void> check_count(std::size_t pieces, const std::string& name) {
  if (pieces <= modal::kMaxPieces) return {};
  return fail(ErrorKind::too_large,
              "{} breaks into more than the {} pieces that a bank may have, over all places and levels; ask for fewer",
              name, modal::kMaxPieces);
}

}  // namespace

Result<modal::Fracture> shatter_body(const Baked& whole, const Shatter& shatter, const BakeOptions& options,
                                     const Progress& progress) {
  const SolvedBody& body = *whole.body;
  const modal::MassProperties& mass = *whole.bank.mass;
  const double min_share = shatter.min_mass_kg > 0 ? shatter.min_mass_kg / mass.mass_kg : shatter::kMinVolumeShare;
  if (!(min_share < 1))
    return fail(ErrorKind::bad_input, whole.bank.name + ": a piece's least mass is above the mass of the body");
  std::vector<Vec3> places_m = shatter.places_m;
  if (places_m.empty()) places_m.push_back(middle_of_surface(body, mass));
  if (progress && !progress("pieces", 0)) return fail_cancelled();
  const dense::BlasThreads one(1);  // or a bake that ends would set it for those that go on
  modal::Fracture fracture = strength_of(body, *whole.bank.material);
  Work work{.progress = progress, .mutex = {}};
  for (const int pieces : shatter.pieces) work.count += places_m.size() * static_cast<std::size_t>(pieces);
  if (auto fits = check_count(work.count, whole.bank.name); !fits) return fail(fits);
  std::size_t count = 0;
  for (const Vec3& place_m : places_m) {
    const auto seeds = shatter::make_seeds(
        body.mesh, {.pattern = shatter.pattern, .pieces = shatter.pieces, .impact_m = place_m, .seed = shatter.seed});
    if (!seeds) return fail(whole.bank.name, seeds);
    Result<shatter::CutBody> parts = shatter::cut_body(body.mesh, seeds->points);
    if (!parts) return fail(whole.bank.name, parts);
    const Cut cut{body, mass, std::move(*parts)};
    const std::vector<shatter::Level> levels = levels_of(cut.parts, body.mesh, seeds->group_of_cell, min_share);
    BakedLevel coarser;
    for (const shatter::Level& level : levels) {
      if (level.pieces.size() < 2)
        return fail(ErrorKind::bad_input, whole.bank.name + " breaks into one piece only; ask for more `pieces`");
      count += level.pieces.size();
      if (auto fits = check_count(count, whole.bank.name); !fits) return fail(fits);
      Result<BakedLevel> pieces =
          bake_level(cut, level, coarser, whole.bank, options_of_piece(options, shatter), place_m, work);
      if (!pieces) return fail(pieces);
      if (&level != &levels.back()) add_second_breaks(*pieces, level, *whole.bank.material);
      modal::BreakPattern& pattern =
          fracture.patterns.emplace_back(modal::BreakPattern{place_m, level.crack_area_m2, {}});
      for (BakedPiece& piece : *pieces) pattern.pieces.push_back(piece.bank);
      coarser = *std::move(pieces);
    }
  }
  return fracture;
}

}  // namespace ringdown::bake
