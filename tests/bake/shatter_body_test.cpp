// A body breaks into pieces: what the pieces have together is what the body had.
#include "engine/bake/shatter_body.h"

#include "engine/shatter/pieces.h"
#include "tests/shatter/bodies.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::shatter_body_test {
namespace {

using bake::Baked;
using bake::BakeOptions;
using bake::Shatter;
using modal::BreakPattern;
using modal::MassProperties;
using modal::PieceBank;

constexpr int kRigid = 6;
const modal::Material kGlass{"glass", 70e9, 0.22, 2500, {0.5, 2e-9}};

// A pane of 120 x 80 x 4 mm, turned and shifted, so that its axes are not those of the frame.
mesh::TetMesh pane(int order = 2) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return test::moved(
      mesh::to_order(test::box_mesh({6, 4, 1}, {0.12, 0.08, 0.004}), order),
      [&](const Eigen::Vector3d& at) { return Eigen::Vector3d(turn * at + Eigen::Vector3d(0.01, -0.05, 0.2)); });
}

// A body, what breaks it, and the pieces.
struct Case {
  std::string name;
  mesh::TetMesh mesh;
  BakeOptions options;
  Shatter shatter;
  Baked whole;
  modal::Fracture fracture;
  [[nodiscard]] const std::vector<PieceBank>& pieces() const { return fracture.patterns.front().pieces; }
  [[nodiscard]] const MassProperties& mass() const { return *whole.bank.mass; }
};

Case broken(const std::string& name, const mesh::TetMesh& mesh, const Shatter& shatter, double top_hz = 20e3) {
  const BakeOptions options{.element = test::element_of(mesh), .band_high_hz = top_hz, .interior = true};
  Case out{.name = name, .mesh = mesh, .options = options, .shatter = shatter};
  out.whole = bake::bake(test::checked(mesh), kGlass, options, name).value();
  out.fracture = bake::shatter_body(out.whole, shatter, options).value();
  return out;
}

const Case& pane_case() {
  static const Case pane_in_eight =
      broken("pane", pane(), {.pieces = {8}, .pattern = shatter::Pattern::kUniform, .band_high_hz = 40e3});
  return pane_in_eight;
}
const Case& bowl_case() {
  static const Case bowl_in_six = broken("bowl", test::bowl(3, 4), {.pieces = {6}, .band_high_hz = 10e3}, 8e3);
  return bowl_in_six;
}
std::vector<const Case*> cases() { return {&pane_case(), &bowl_case()}; }

// The meshes of the pieces, found again with the arguments that shatter_body() gives the parts of engine/shatter.
std::vector<shatter::PieceMesh> meshes_of_pieces(const Case& body) {
  const mesh::TetMesh& mesh = body.whole.body->mesh;
  const Vec3 at_m = body.fracture.patterns.front().at_m;
  const auto seeds = shatter::make_seeds(
      mesh,
      {.pattern = body.shatter.pattern, .pieces = body.shatter.pieces, .impact_m = at_m, .seed = body.shatter.seed});
  const shatter::CutBody cut = shatter::cut_body(mesh, seeds->points).value();
  const shatter::Level level = levels_of(cut, mesh, seeds->group_of_cell).front();
  std::vector<shatter::PieceMesh> meshes;
  for (std::int32_t k = 0; k < std::ssize(level.pieces); ++k)
    meshes.push_back(piece_mesh(cut, mesh, elements_of(level, k)));
  return meshes;
}

Eigen::Vector3d vector_of(const Vec3& v) { return {v.x, v.y, v.z}; }

// Columns: the principal axes.
Eigen::Matrix3d axes_of(const MassProperties& mass) {
  const auto& q = mass.orientation;
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
}

Eigen::Matrix3d tensor_of(const MassProperties& mass) {
  const Eigen::Matrix3d axes = axes_of(mass);
  return axes * vector_of(mass.inertia_kg_m2).asDiagonal() * axes.transpose();
}

Eigen::MatrixXd handover_of(const Case& body, const PieceBank& piece) {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto rows = static_cast<Eigen::Index>(kRigid + piece.bank.mode_count());
  const auto columns = static_cast<Eigen::Index>(kRigid + body.whole.bank.mode_count());
  EXPECT_EQ(std::ssize(piece.handover), rows * columns);
  return Eigen::Map<const Rows>(piece.handover.data(), rows, columns).cast<double>();
}

TEST(ShatterBody, MassCentreAndInertiaOfThePiecesAreThoseOfTheBody) {
  for (const Case* body : cases()) {
    EXPECT_GE(body->pieces().size(), 5u) << body->name;
    const Eigen::Vector3d centre = vector_of(body->mass().center_of_mass_m);
    const Eigen::Matrix3d whole = tensor_of(body->mass());
    double mass_kg = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const PieceBank& piece : body->pieces()) {
      const MassProperties& mass = *piece.bank.mass;
      const Eigen::Vector3d arm = vector_of(mass.center_of_mass_m) - centre;
      mass_kg += mass.mass_kg;
      moment += mass.mass_kg * arm;
      sum += tensor_of(mass) + mass.mass_kg * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    EXPECT_NEAR(mass_kg / body->mass().mass_kg, 1, 1e-12) << body->name;
    EXPECT_LT(moment.norm() / mass_kg, 1e-12) << body->name;
    EXPECT_LT((sum - whole).norm() / whole.norm(), 1e-10) << body->name;
  }
}

// A translation moves a piece along, and a turn about the body's centre moves the piece's centre and turns the piece.
// No mode of a piece takes part, and all of the energy arrives.
TEST(ShatterBody, TheHandoverOfRigidMotionIsTheClosedForm) {
  for (const Case* body : cases()) {
    Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(kRigid);
    const Eigen::Matrix3d axes = axes_of(body->mass());
    const Eigen::Vector3d inertia = vector_of(body->mass().inertia_kg_m2);
    for (const PieceBank& piece : body->pieces()) {
      const MassProperties& mass = *piece.bank.mass;
      const Eigen::Vector3d arm = vector_of(mass.center_of_mass_m) - vector_of(body->mass().center_of_mass_m);
      const Eigen::Vector3d own = vector_of(mass.inertia_kg_m2);
      Eigen::Matrix<double, kRigid, kRigid> expected = Eigen::Matrix<double, kRigid, kRigid>::Zero();
      for (int j = 0; j < 3; ++j) {
        expected(j, j) = std::sqrt(mass.mass_kg / body->mass().mass_kg);
        expected.block<3, 1>(0, 3 + j) = std::sqrt(mass.mass_kg / inertia[j]) * Eigen::Vector3d(axes.col(j)).cross(arm);
        for (int i = 0; i < 3; ++i)
          expected(3 + i, 3 + j) = std::sqrt(own[i] / inertia[j]) * axes_of(mass).col(i).dot(axes.col(j));
      }
      const Eigen::MatrixXd p = handover_of(*body, piece).leftCols(kRigid);
      EXPECT_LT((p.topRows(kRigid) - expected).cwiseAbs().maxCoeff(), 1e-6) << body->name;
      EXPECT_LT(p.bottomRows(p.rows() - kRigid).norm(), 1e-5) << body->name;
      sums += p.colwise().squaredNorm();
    }
    for (int j = 0; j < kRigid; ++j) EXPECT_NEAR(sums[j], 1, 1e-5) << body->name << " " << j;
  }
}

// Sums of squares of the columns of the body's modes over all pieces, by ascending frequency.
std::vector<double> shares(const Case& body) {
  const Eigen::Index modes = static_cast<Eigen::Index>(body.whole.bank.mode_count());
  Eigen::RowVectorXd sums = Eigen::RowVectorXd::Zero(modes);
  for (const PieceBank& piece : body.pieces())
    sums += handover_of(body, piece).rightCols(modes).colwise().squaredNorm();
  std::vector<std::size_t> order(static_cast<std::size_t>(modes));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t m) { return body.whole.bank.frequency_hz[m]; });
  std::vector<double> sorted;
  for (const std::size_t m : order) sorted.push_back(sums[static_cast<Eigen::Index>(m)]);
  return sorted;
}

TEST(ShatterBody, PiecesTakeNoMoreThanTheBodysModeHas) {
  for (const Case* body : cases()) {
    ASSERT_GE(body->whole.bank.mode_count(), 4u) << body->name;
    for (const double share : shares(*body)) EXPECT_LE(share, 1 + 1e-5) << body->name;
  }
}

TEST(ShatterBody, PiecesOfAHighBandTakeNearlyAllOfTheBodysLowModes) {
  std::vector<double> before(4, 0);
  for (const double top_hz : {20e3, 60e3, 200e3}) {
    const Case high =
        broken("pane", pane(), {.pieces = {6}, .pattern = shatter::Pattern::kUniform, .band_high_hz = top_hz});
    const std::vector<double> now = shares(high);
    for (std::size_t m = 0; m < before.size(); ++m) {
      EXPECT_LE(now[m], 1 + 1e-5);
      EXPECT_GE(now[m], before[m] - 1e-6) << "more modes of pieces cannot take less";
      if (top_hz > 100e3) {
        EXPECT_GT(now[m], 0.9);
      }
      before[m] = now[m];
    }
  }
}

// Finds the place of a point in a body of straight elements: its element and the coordinates there.
struct Located {
  Eigen::Index element = -1;
  Eigen::Vector4d barycentric;
};
Located located(const mesh::TetMesh& straight, const Eigen::Vector3d& at) {
  Located best;
  double best_least = -1;
  for (Eigen::Index e = 0; e < straight.elements.rows(); ++e) {
    Eigen::Matrix4d corners;
    for (int c = 0; c < 4; ++c) corners.col(c) << straight.nodes.row(straight.elements(e, c)).transpose(), 1;
    const Eigen::Vector4d barycentric = corners.inverse() * Eigen::Vector4d(at[0], at[1], at[2], 1);
    if (barycentric.minCoeff() > best_least) best = {e, barycentric}, best_least = barycentric.minCoeff();
  }
  EXPECT_GT(best_least, -1e-9) << "the point is outside of the body";
  return best;
}

// All displacements at a point of an element, 3 x modes. Shape functions of tetrahedra of order 2, from any book.
Eigen::MatrixXd quadratic_field(const mesh::TetMesh& mesh, const Eigen::MatrixXd& shapes, const Located& place) {
  const Eigen::Vector4d& l = place.barycentric;
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(3, shapes.cols());
  constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (int a = 0; a < 10; ++a) {
    const double value = a < 4 ? l[a] * (2 * l[a] - 1) : 4 * l[kEnds[a - 4][0]] * l[kEnds[a - 4][1]];
    field += value * shapes.middleRows(3 * mesh.elements(place.element, a), 3);
  }
  return field;
}

// The integral of rho psi_k . phi_j over the piece, by quadrature over its elements; phi_j is looked up in the body.
TEST(ShatterBody, TheHandoverOfModesIsTheIntegralOverThePiece) {
  const Case& body = pane_case();
  const bake::SolvedBody& whole = *body.whole.body;
  const std::vector<shatter::PieceMesh> meshes = meshes_of_pieces(body);
  ASSERT_EQ(meshes.size(), body.pieces().size());
  const auto rule = mesh::tet_quadrature(4);
  std::size_t checked = 0;
  for (const std::size_t number : {std::size_t{0}, meshes.size() - 1}) {
    const PieceBank& piece = body.pieces()[number];
    const mesh::TetMesh& mesh = meshes[number].mesh;
    const Baked again = bake::bake(test::checked(mesh), kGlass,
                                   {.element = body.options.element,
                                    .band_high_hz = body.shatter.band_high_hz,
                                    .may_be_silent = true,
                                    .interior = true},
                                   "piece")
                            .value();
    ASSERT_EQ(again.bank.frequency_hz, piece.bank.frequency_hz);
    Eigen::MatrixXd integral = Eigen::MatrixXd::Zero(again.body->shapes.cols(), whole.shapes.cols());
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      Eigen::Matrix3d edges;
      for (int c = 1; c < 4; ++c)
        edges.col(c - 1) = (mesh.nodes.row(mesh.elements(e, c)) - mesh.nodes.row(mesh.elements(e, 0))).transpose();
      for (const mesh::QuadraturePoint& point : rule) {
        const Eigen::Vector3d at =
            mesh.nodes.row(mesh.elements(e, 0)).transpose() + edges * point.barycentric.tail<3>();
        const double mass_kg = kGlass.density_kg_m3 * point.weight * edges.determinant() / 6;
        integral += mass_kg *
                    quadratic_field(again.body->mesh, again.body->shapes, {e, point.barycentric}).transpose() *
                    quadratic_field(whole.mesh, whole.shapes, located(whole.mesh, at));
      }
    }
    const Eigen::MatrixXd p = handover_of(body, piece).bottomRightCorner(integral.rows(), integral.cols());
    ASSERT_GT(p.cwiseAbs().maxCoeff(), 0.05) << "else nothing is compared";
    EXPECT_LT((p - integral).cwiseAbs().maxCoeff(), 1e-6);
    checked += static_cast<std::size_t>(p.size());
  }
  EXPECT_GT(checked, 20u);
}

struct Energies {
  double mass = 0, stiffness = 0;  // x' M x, x' K x
};
void add(Energies& sum, const mesh::TetMesh& mesh, const Eigen::VectorXd& x) {
  const fem::Elastic glass{kGlass.youngs_modulus_pa, kGlass.poisson_ratio, kGlass.density_kg_m3};
  const fem::System system = fem::assemble(mesh, glass, test::element_of(mesh)).value();
  sum.mass += x.dot(Eigen::VectorXd(fem::mass_times(system.node_mass, x)));
  sum.stiffness += x.dot(system.stiffness.selfadjointView<Eigen::Lower>() * x);
}
Energies energies_of_pieces(const Case& body, const Eigen::VectorXd& x) {
  Energies sum;
  for (const shatter::PieceMesh& piece : meshes_of_pieces(body))
    add(sum, piece.mesh, restricted(piece, body.whole.body->mesh, x));
  return sum;
}

TEST(ShatterBody, MassAndStiffnessOfAnyFieldAreTheSumOverThePieces) {
  for (const Case* body : cases()) {
    const mesh::TetMesh& mesh = body->whole.body->mesh;
    std::mt19937 random(5);
    std::normal_distribution<double> number;
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(3 * mesh.nodes.rows(), [&] { return number(random); });
    Energies whole;
    add(whole, mesh, x);
    const Energies pieces = energies_of_pieces(*body, x);
    EXPECT_NEAR(pieces.mass / whole.mass, 1, 1e-9) << body->name;
    // Gradients in curved elements are rational functions, which no quadrature integrates exactly: the bowl's sums
    // differ by 1.0e-8.
    const bool is_straight = body == &pane_case();
    EXPECT_NEAR(pieces.stiffness / whole.stiffness, 1, is_straight ? 1e-9 : 2e-8) << body->name;
  }
}

// An affine field has one strain everywhere, also in curved elements: x' K x = volume * strain : C : strain.
TEST(ShatterBody, AnEvenStrainOfThePiecesHasTheEnergyOfTheClosedForm) {
  Eigen::Matrix3d slope;
  slope << 0.3, -1.1, 0.4, 0.8, 0.2, -0.5, 0.1, 0.7, -0.6;
  const Eigen::Matrix3d strain = (slope + slope.transpose()) / 2;
  const fem::Elastic glass{kGlass.youngs_modulus_pa, kGlass.poisson_ratio, kGlass.density_kg_m3};
  const double density_j_m3 =
      glass.lambda_pa() * strain.trace() * strain.trace() + 2 * glass.mu_pa() * strain.squaredNorm();
  for (const Case* body : cases()) {
    const mesh::Points moved = body->whole.body->mesh.nodes * slope.transpose();
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(moved.data(), moved.size());
    const double volume_m3 = body->mass().mass_kg / kGlass.density_kg_m3;
    EXPECT_NEAR(energies_of_pieces(*body, x).stiffness / (volume_m3 * density_j_m3), 1, 1e-9) << body->name;
  }
}

std::vector<double> lowest(std::vector<double> frequencies, std::size_t count) {
  std::ranges::sort(frequencies);
  frequencies.resize(std::min(count, frequencies.size()));
  return frequencies;
}

TEST(ShatterBody, FrequenciesOfAPieceAreThoseOfAFinerMesh) {
  for (const Case& body : {broken("pane", pane(3), {.pieces = {4}, .pattern = shatter::Pattern::kUniform}, 3e3),
                           broken("bowl", test::bowl(3, 8),
                                  {.pieces = {4}, .pattern = shatter::Pattern::kUniform, .band_high_hz = 4e3}, 1e3)}) {
    const auto mass_of = [](const PieceBank& piece) { return piece.bank.mass->mass_kg; };
    const auto largest = std::ranges::max_element(body.pieces(), {}, mass_of);
    const auto number = static_cast<std::size_t>(largest - body.pieces().begin());
    const std::vector<double> coarse = lowest(largest->bank.frequency_hz, 4);
    ASSERT_EQ(coarse.size(), 4u) << body.name;
    const mesh::TetMesh fine = mesh::to_order(meshes_of_pieces(body)[number].mesh, body.mesh.order() + 1);
    const Baked exact = bake::bake(test::checked(fine), kGlass,
                                   {.element = test::element_of(fine), .band_high_hz = 1.2 * coarse.back()}, "piece")
                            .value();
    const std::vector<double> expected = lowest(exact.bank.frequency_hz, 4);
    ASSERT_EQ(expected.size(), 4u);
    for (std::size_t m = 0; m < 4; ++m) {
      EXPECT_NEAR(coarse[m] / expected[m], 1, 0.01) << body.name << " " << m;
    }
  }
}

TEST(ShatterBody, APieceWithoutAModeInItsBandHasASurfaceAndAMass) {
  const Case low = broken("pane", pane(), {.pieces = {8}, .pattern = shatter::Pattern::kUniform, .band_high_hz = 9e3});
  std::size_t silent = 0;
  for (const PieceBank& piece : low.pieces()) {
    EXPECT_GT(piece.bank.mass->mass_kg, 0);
    EXPECT_GE(piece.bank.point_count(), 4u);
    EXPECT_GE(piece.bank.triangles.size(), 4u);
    for (const auto& triangle : piece.bank.triangles) EXPECT_LT(std::ranges::max(triangle), piece.bank.point_count());
    EXPECT_EQ(piece.bank.shapes.size(), piece.bank.mode_count() * piece.bank.point_count());
    EXPECT_EQ(piece.handover.size(), (kRigid + piece.bank.mode_count()) * (kRigid + low.whole.bank.mode_count()));
    silent += piece.bank.mode_count() == 0 ? 1 : 0;
  }
  EXPECT_GE(silent, 1u);
}

// The distances are those of nodes. A point of an edge may be nearer than both of its ends, here by less than 0.1 mm.
TEST(ShatterBody, TheCrackOpensFromThePiecesNearestPointToItsFarthest) {
  for (const Case* body : cases()) {
    const BreakPattern& pattern = body->fracture.patterns.front();
    double nearest_m = 1, farthest_m = 0;
    for (const PieceBank& piece : pattern.pieces) {
      EXPECT_LE(piece.near_m, piece.far_m);
      nearest_m = std::min(nearest_m, piece.near_m);
      farthest_m = std::max(farthest_m, piece.far_m);
      for (const modal::Vec3f& p : piece.bank.positions) {
        const double distance_m = length(Vec3{p[0], p[1], p[2]} - pattern.at_m);
        EXPECT_GE(distance_m, piece.near_m - 1e-4) << body->name;
        EXPECT_LE(distance_m, piece.far_m + 1e-4) << body->name;
      }
    }
    EXPECT_LT(nearest_m, 1e-9) << "without a place, the blow is on the surface";
    const Eigen::VectorXd distances =
        (body->mesh.nodes.rowwise() - vector_of(pattern.at_m).transpose()).rowwise().norm();
    EXPECT_NEAR(farthest_m, distances.maxCoeff(), 1e-9);
  }
}

void expect_same(const modal::Fracture& a, const modal::Fracture& b) {
  ASSERT_EQ(a.patterns.size(), b.patterns.size());
  for (std::size_t p = 0; p < a.patterns.size(); ++p) {
    EXPECT_EQ(a.patterns[p].at_m, b.patterns[p].at_m);
    EXPECT_EQ(a.patterns[p].crack_area_m2, b.patterns[p].crack_area_m2);
    ASSERT_EQ(a.patterns[p].pieces.size(), b.patterns[p].pieces.size());
    for (std::size_t i = 0; i < a.patterns[p].pieces.size(); ++i) {
      const PieceBank &one = a.patterns[p].pieces[i], &other = b.patterns[p].pieces[i];
      EXPECT_EQ(one.bank.name, other.bank.name);
      EXPECT_EQ(one.bank.frequency_hz, other.bank.frequency_hz);
      EXPECT_EQ(one.bank.decay_per_s, other.bank.decay_per_s);
      EXPECT_EQ(one.bank.positions, other.bank.positions);
      EXPECT_EQ(one.bank.shapes, other.bank.shapes);
      EXPECT_EQ(one.bank.triangles, other.bank.triangles);
      EXPECT_EQ(one.handover, other.handover);
      EXPECT_EQ(one.near_m, other.near_m);
      EXPECT_EQ(one.far_m, other.far_m);
    }
  }
}

TEST(ShatterBody, TheSameBodyBreaksTheSameWayOnAnyNumberOfThreads) {
  const Case& body = pane_case();
  const char* const before = std::getenv("RINGDOWN_THREADS");
  const std::optional<std::string> kept = before == nullptr ? std::nullopt : std::optional<std::string>(before);
  for (const char* threads : {"1", "3"}) {
    SCOPED_TRACE(threads);
    ::setenv("RINGDOWN_THREADS", threads, 1);
    const auto again = bake::shatter_body(body.whole, body.shatter, body.options);
    ASSERT_TRUE(again) << again.error().message;
    expect_same(*again, body.fracture);
  }
  kept ? ::setenv("RINGDOWN_THREADS", kept->c_str(), 1) : ::unsetenv("RINGDOWN_THREADS");
}

TEST(ShatterBody, EveryPlaceAndEveryLevelHasAPattern) {
  const Case& body = pane_case();
  const Eigen::RowVector3d a = body.mesh.nodes.row(0), b = body.mesh.nodes.row(7);
  const std::vector<Vec3> places_m = {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
  double last = 0;
  const auto fracture = bake::shatter_body(body.whole, {.pieces = {2, 5}, .places_m = places_m, .band_high_hz = 5e3},
                                           body.options, [&](std::string_view stage, double fraction) {
                                             EXPECT_EQ(stage, "pieces");
                                             EXPECT_GE(fraction, last);
                                             last = fraction;
                                             return true;
                                           });
  ASSERT_TRUE(fracture) << fracture.error().message;
  ASSERT_EQ(fracture->patterns.size(), 4u);
  for (std::size_t p = 0; p < 4; ++p) EXPECT_EQ(fracture->patterns[p].at_m, places_m[p / 2]);
  for (const std::size_t p : {0, 2}) {
    EXPECT_LT(fracture->patterns[p].pieces.size(), fracture->patterns[p + 1].pieces.size());
    EXPECT_LT(fracture->patterns[p].crack_area_m2, fracture->patterns[p + 1].crack_area_m2);
  }
}

TEST(ShatterBody, WhatCannotBreakIsRefusedWithOneSentence) {
  const Case& body = pane_case();
  const auto refusal = [&](const Shatter& shatter) {
    const auto fracture = bake::shatter_body(body.whole, shatter, body.options);
    return fracture ? "accepted" : fracture.error().message;
  };
  const double mass_kg = body.mass().mass_kg;
  EXPECT_EQ(refusal({.pieces = {4}, .min_mass_kg = 2 * mass_kg}),
            "pane: a piece's least mass is above the mass of the body");
  EXPECT_EQ(refusal({.pieces = {4}, .min_mass_kg = 0.9 * mass_kg}),
            "pane breaks into one piece only; ask for more `pieces`");
  EXPECT_EQ(refusal({.pieces = {4}, .places_m = {{9, 9, 9}}}).find("pane: "), 0u);
  EXPECT_NE(refusal({.pieces = {500}, .places_m = std::vector<Vec3>(16, body.fracture.patterns.front().at_m)})
                .find("1024 pieces"),
            std::string::npos);
  for (const int stop_after : {0, 2}) {
    int calls = 0;
    const auto cancelled = bake::shatter_body(body.whole, body.shatter, body.options,
                                              [&](std::string_view, double) { return calls++ < stop_after; });
    ASSERT_FALSE(cancelled);
    EXPECT_EQ(cancelled.error().kind, ErrorKind::cancelled);
  }
}

}  // namespace
}  // namespace ringdown::shatter_body_test
