// The oracles for banks: that they are right about cases whose answer is known, and what they say of a bank with all
// points.
#include "tests/bake/amplitude_error.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/gmsh_reader.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/bank_surface.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace ringdown::amplitude_test {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using test::CurvedSkin;
using test::SkinPoint;
using test::TemporaryFolder;

const Vector3d kBox(0.3, 0.2, 0.05);
const modal::Material kSteel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}};

double area_of_box(const Vector3d& size) { return 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]); }

// How far a point is from the nearest face of the box, and that face's outward normal.
std::pair<double, Vector3d> nearest_face(const Vector3d& at) {
  std::pair<double, Vector3d> nearest(1, Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.0, kBox[axis]}) {
      const double distance = std::abs(at[axis] - side);
      if (distance < nearest.first) nearest = {distance, (side > 0 ? 1 : -1) * Vector3d::Unit(axis)};
    }
  }
  return nearest;
}

TEST(CurvedSkin, PointsOfABoxLieOnItsFacesAndLookOutward) {
  for (int order = 1; order <= 4; ++order) {
    const CurvedSkin skin(mesh::to_order(test::box_mesh({3, 2, 2}, kBox), order));
    EXPECT_EQ(skin.face_count(), 4u * (3 * 2 + 2 * 2 + 2 * 3));
    EXPECT_NEAR(skin.area(), area_of_box(kBox), 1e-12);
    for (const SkinPoint& point : skin.random_points(300, 1)) {
      const auto [distance, outward] = nearest_face(point.at_m);
      ASSERT_LT(distance, 1e-12) << order;
      ASSERT_LT((point.normal - outward).norm(), 1e-9) << order;
    }
  }
}

// The p-th power of a linear form: its value at any point follows from those at the nodes only when each node is taken
// for the place where it lies.
TEST(CurvedSkin, APolynomialOfTheElementsDegreeIsReproduced) {
  const Vector3d slope(3, -4, 7);
  for (int order = 1; order <= 4; ++order) {
    const mesh::TetMesh box = mesh::to_order(test::box_mesh({3, 2, 2}, kBox), order);
    const CurvedSkin skin(box);
    Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * static_cast<Index>(skin.nodes().size()), 2);
    for (std::size_t s = 0; s < skin.nodes().size(); ++s) {
      const double form = box.nodes.row(skin.nodes()[s]).dot(slope);
      shapes(3 * static_cast<Index>(s) + 1, 1) = std::pow(form, order);
    }
    for (const SkinPoint& point : skin.random_points(300, 2)) {
      const Eigen::Matrix3Xd at = displacement(point, shapes);
      ASSERT_NEAR(at(1, 1), std::pow(point.at_m.dot(slope), order), 1e-12) << order;
      ASSERT_EQ(at.cwiseAbs().sum(), std::abs(at(1, 1)));
    }
  }
}

TEST(CurvedSkin, TheSkinOfARoundBallIsRound) {
  const double radius_m = 0.1;
  const auto ball = mesh::read_with_gmsh(std::filesystem::path(RINGDOWN_SOURCE_DIR) / "tests/bench/modal/sphere.geo",
                                         {.unit_m = 0.001, .mesh_size_m = 0.04, .order = 3, .parameters = {}});
  ASSERT_TRUE(ball) << ball.error().message;
  const CurvedSkin skin(ball->mesh);
  EXPECT_NEAR(skin.area() / (4 * std::numbers::pi * radius_m * radius_m), 1, 1e-3);
  const std::vector<SkinPoint> points = skin.random_points(20000, 3);
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const SkinPoint& point : points) {
    ASSERT_NEAR(point.at_m.norm() / radius_m, 1, 1e-3);
    ASSERT_GT(point.normal.dot(point.at_m.normalized()), 0.999);
    second += point.at_m * point.at_m.transpose() / (radius_m * radius_m * static_cast<double>(points.size()));
  }
  // One third each way. Of a uniform coordinate's square on the unit sphere the standard deviation is 0.298.
  EXPECT_LT((second - Eigen::Matrix3d::Identity() / 3).cwiseAbs().maxCoeff(), 5 * 0.298 / std::sqrt(20000.0));
}

// Nodes between the corners slide along the faces of a box. The box stays as it is, and so does the even distribution,
// though the elements' own coordinates are stretched here and squeezed there.
TEST(CurvedSkin, StretchedElementsDoNotGatherPoints) {
  mesh::TetMesh box = mesh::to_order(test::box_mesh({1, 1, 1}, kBox), 2);
  for (Index n = 0; n < box.nodes.rows(); ++n) {
    if (std::abs(box.nodes(n, 0) / kBox[0] - 0.5) < 0.1) box.nodes(n, 0) -= 0.15 * kBox[0];
  }
  const CurvedSkin skin(box);
  EXPECT_NEAR(skin.area(), area_of_box(kBox), 1e-3 * area_of_box(kBox));
  const auto points = skin.random_points(20000, 4);
  const auto left = std::count_if(points.begin(), points.end(), [](const SkinPoint& p) { return p.at_m[0] < 0.15; });
  EXPECT_NEAR(static_cast<double>(left) / 20000, 0.5, 5 * 0.5 / std::sqrt(20000.0));
}

// A made-up solution on a box: displacement along z, each mode a function of place.
using Field = std::function<double(const Vector3d&)>;

test::Solution solution_of(const mesh::TetMesh& mesh, const std::vector<Field>& fields) {
  const CurvedSkin skin(mesh);
  const auto count = static_cast<Index>(fields.size());
  test::Solution solution{mesh, Eigen::VectorXd(count),
                          Eigen::MatrixXd::Zero(3 * static_cast<Index>(skin.nodes().size()), count)};
  for (Index m = 0; m < count; ++m) {
    solution.frequency_hz[m] = 100.0 * static_cast<double>(m + 1);
    for (std::size_t s = 0; s < skin.nodes().size(); ++s) {
      solution.shapes(3 * static_cast<Index>(s) + 2, m) =
          fields[static_cast<std::size_t>(m)](mesh.nodes.row(skin.nodes()[s]).transpose());
    }
  }
  return solution;
}

// A bank of the solution at all points of the surface.
modal::Bank whole_bank(const test::Solution& solution) {
  const mesh::Boundary surface = mesh::boundary_of(solution.mesh);
  modal::Bank bank;
  bank.name = "all points";
  bank.triangles = surface.triangles;
  for (const std::int32_t node : surface.nodes) {
    const Eigen::RowVector3f at = solution.mesh.nodes.row(node).cast<float>();
    bank.positions.push_back({at[0], at[1], at[2]});
  }
  for (Index m = 0; m < solution.shapes.cols(); ++m) {
    bank.frequency_hz.push_back(solution.frequency_hz[m]);
    bank.decay_per_s.push_back(1);
    const Eigen::VectorXf shape = solution.shapes.col(m).cast<float>();
    for (Index row = 0; row < shape.size(); row += 3)
      bank.shapes.push_back({shape[row], shape[row + 1], shape[row + 2]});
  }
  return bank;
}

test::AmplitudeErrors errors_of(const modal::Bank& bank, const test::Solution& solution) {
  const auto errors = test::amplitude_errors(bank, solution);
  EXPECT_TRUE(errors) << errors.error().message;
  return errors.value_or(test::AmplitudeErrors());
}

const std::vector<Field> kLinear = {[](const Vector3d&) { return 1.0; }, [](const Vector3d& x) { return x[0] - 0.1; },
                                    [](const Vector3d& x) { return 2 * x[0] - 3 * x[1] + x[2]; }};

TEST(AmplitudeError, LinearInterpolationOfALinearShapeErrsByRoundingOnly) {
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({3, 2, 1}, kBox), 3), kLinear);
  const test::AmplitudeErrors errors = errors_of(whole_bank(solution), solution);
  EXPECT_LT(errors.largest, 1e-5);
  EXPECT_LT(errors.worst_region, 1e-5);
}

// Between points of distance h the interpolation of x^2 is off by (x - x0)(x1 - x), of mean square h^4 / 30, on the
// four sides along x; on the two ends it is right.
TEST(AmplitudeError, LinearInterpolationOfAParabolaErrsByTheClosedForm) {
  const int cells = 3, order = 3;
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({cells, 2, 1}, kBox), order),
                                              {[](const Vector3d& x) { return x[0] * x[0]; }});
  const double length = kBox[0], h = length / (cells * order), end = kBox[1] * kBox[2], area = area_of_box(kBox);
  const double along = area - 2 * end;
  const double truth = along * std::pow(length, 4) / 5 + end * std::pow(length, 4);
  const double expected = std::sqrt(along * std::pow(h, 4) / 30 / truth);
  const test::AmplitudeErrors errors = errors_of(whole_bank(solution), solution);
  EXPECT_NEAR(errors.by_mode[0] / expected, 1, 0.03);
}

TEST(AmplitudeError, TheOrderOfModesAndTheirSignsAreTheBanksChoice) {
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({3, 2, 1}, kBox), 2), kLinear);
  test::Solution other = solution;
  other.shapes.col(0) = -solution.shapes.col(2);
  other.shapes.col(2) = solution.shapes.col(0);
  std::swap(other.frequency_hz[0], other.frequency_hz[2]);
  EXPECT_LT(errors_of(whole_bank(other), solution).largest, 1e-5);
}

TEST(AmplitudeError, AmongEqualFrequenciesEachModeFindsItsOwn) {
  test::Solution solution = solution_of(mesh::to_order(test::box_mesh({3, 2, 1}, kBox), 2), kLinear);
  solution.frequency_hz.setConstant(440);
  test::Solution other = solution;
  other.shapes.col(0).swap(other.shapes.col(1));
  EXPECT_LT(errors_of(whole_bank(other), solution).largest, 1e-5);
}

TEST(AmplitudeError, AModeThatIsFivePercentTooStrongErrsByFivePercent) {
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({3, 2, 1}, kBox), 2), kLinear);
  test::Solution other = solution;
  other.shapes.col(1) *= 1.05;
  const test::AmplitudeErrors errors = errors_of(whole_bank(other), solution);
  EXPECT_NEAR(errors.by_mode[1], 0.05, 1e-5);
  EXPECT_NEAR(errors.largest, 0.05, 1e-5);
  EXPECT_LT(errors.median, 1e-5);
}

TEST(AmplitudeError, OneSpoiledPointIsFoundInItsRegion) {
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({6, 4, 1}, kBox), 3), kLinear);
  modal::Bank bank = whole_bank(solution);
  const auto good = errors_of(bank, solution);
  const std::size_t spoiled = bank.point_count() / 2;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) bank.shapes[m * bank.point_count() + spoiled][2] += 1;
  const test::AmplitudeErrors errors = errors_of(bank, solution);
  EXPECT_GT(errors.worst_region, 0.1);
  EXPECT_GT(errors.worst_region, 3 * errors.median) << "what is wrong in one place shows there most";
  const modal::Vec3f& at = bank.positions[spoiled];
  EXPECT_LT((errors.worst_place - Vector3d(at[0], at[1], at[2])).norm(), 0.06);
}

TEST(AmplitudeError, ABankOfAnotherBodyIsRefused) {
  const test::Solution solution = solution_of(mesh::to_order(test::box_mesh({3, 2, 1}, kBox), 2), kLinear);
  modal::Bank bank = whole_bank(solution);
  bank.frequency_hz[1] *= 1 + 2e-6;
  const auto errors = test::amplitude_errors(bank, solution);
  ASSERT_FALSE(errors);
  EXPECT_NE(errors.error().message.find("its mode at 200.000400 Hz is not in the solution"), std::string::npos);
}

// A box's surface is whole and well shaped; then it loses a triangle, has a node moved onto another, and a corner
// pulled.
TEST(BankSurface, HolesFlatTrianglesAndLostVolumeAreCounted) {
  modal::Bank box = whole_bank(solution_of(mesh::to_order(test::box_mesh({6, 4, 1}, kBox), 2), kLinear));
  box.material = modal::Material{"water", 1, 0, 1000, {}};
  box.mass = modal::MassProperties{.mass_kg = 1000 * kBox.prod()};
  const test::BankSurface whole = test::look_at_surface(box);
  EXPECT_EQ(whole.open_edges, 0u);
  EXPECT_EQ(whole.flat, 0u);
  EXPECT_EQ(whole.needles, 0u);
  EXPECT_NEAR(whole.min_angle_deg, 45, 1e-3);
  EXPECT_NEAR(whole.volume_error, 0, 1e-6);

  modal::Bank open = box;
  open.triangles.pop_back();
  EXPECT_EQ(test::look_at_surface(open).open_edges, 3u);

  modal::Bank flat = box;
  const auto inner = std::find_if(box.triangles.begin(), box.triangles.end(), [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t p) {
      const modal::Vec3f& at = box.positions[p];
      return at[2] == 0 && at[0] > 0.01 && at[0] < 0.29 && at[1] > 0.01 && at[1] < 0.19;
    });
  });
  ASSERT_NE(inner, box.triangles.end());
  flat.positions[(*inner)[0]] = box.positions[(*inner)[1]];
  EXPECT_GE(test::look_at_surface(flat).flat, 2u);
  EXPECT_GE(test::look_at_surface(flat).needles, 2u);

  modal::Bank larger = box;
  for (modal::Vec3f& at : larger.positions) at[2] *= 1.02F;
  EXPECT_NEAR(test::look_at_surface(larger).volume_error, 0.02, 1e-5);
}

// A body, its modes in a cache, and its bank as written and read back.
struct BakedBody {
  modal::Bank bank;
  test::Solution solution;
};

BakedBody bake_body(const mesh::CheckedMesh& mesh, bake::BakeOptions options, const std::string& name) {
  const TemporaryFolder folder;
  options.cache = folder.path();
  const auto baked = bake::bake(mesh, kSteel, options, name);
  EXPECT_TRUE(baked) << baked.error().message;
  const auto solution = test::kept_solution(mesh.mesh, kSteel, options);
  EXPECT_TRUE(solution) << solution.error().message;
  EXPECT_TRUE(modal::write_bank(baked->bank, folder / "bank.glb"));
  return {modal::read_bank(folder / "bank.glb").value(), *solution};
}

// Three unlike edges, so that no two frequencies of the plate are equal and each shape is unique but for its sign.
TEST(AmplitudeError, WhatIsTakenForTruthIsWhatASolveOfItsOwnFinds) {
  const mesh::CheckedMesh plate = test::checked(test::box_mesh({5, 4, 1}, {0.25, 0.18, 0.003}));
  const test::Solution kept = bake_body(plate, {.band_high_hz = 3000}, "plate").solution;
  const auto system = fem::assemble(kept.mesh, fem::Elastic{200e9, 0.3, 7850}, fem::Element::kTet20);
  ASSERT_TRUE(system);
  const double top = 2 * std::numbers::pi * 3000;
  const auto own = solve::solve_modes(*system, {.highest_lambda = top * top, .rigid = 6});
  ASSERT_TRUE(own);
  const std::vector<std::int32_t> nodes = CurvedSkin(kept.mesh).nodes();
  ASSERT_GT(kept.shapes.cols(), 10);
  for (Index m = 0; m < kept.shapes.cols(); ++m) {
    const double lambda = own->lambda[6 + m], decay = (kSteel.damping.alpha_per_s + kSteel.damping.beta_s * lambda) / 2;
    EXPECT_NEAR(kept.frequency_hz[m] * 2 * std::numbers::pi / std::sqrt(lambda - decay * decay), 1, 1e-8) << m;
    Eigen::VectorXd shape(kept.shapes.rows());
    for (std::size_t s = 0; s < nodes.size(); ++s)
      shape.segment<3>(3 * static_cast<Index>(s)) = own->shapes.col(6 + m).segment<3>(3 * nodes[s]);
    const double sign = shape.dot(kept.shapes.col(m)) < 0 ? -1 : 1;
    EXPECT_LT((sign * shape - kept.shapes.col(m)).norm() / shape.norm(), 1e-5) << m;
  }
}

// A bar of a mesh so fine that points a third of an element apart follow its shortest wave.
TEST(StrikeAtAllPoints, ABankWithAllPointsOfAFineMeshIsRight) {
  const mesh::CheckedMesh bar = test::checked(test::box_mesh({16, 2, 2}, {0.2, 0.02, 0.01}));
  const BakedBody body = bake_body(bar, {.points = 100000}, "bar");
  const test::AmplitudeErrors errors = errors_of(body.bank, body.solution);
  EXPECT_LT(errors.median, 0.01);
  EXPECT_LT(errors.largest, 0.03);
  EXPECT_LT(errors.worst_region, 0.03);
}

}  // namespace
}  // namespace ringdown::amplitude_test
