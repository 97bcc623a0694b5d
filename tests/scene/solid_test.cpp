#include "engine/scene/solid.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown::scene::solid_test {
namespace {

constexpr Vec3 kSize{0.1, 0.2, 0.3}, kCenter{1, 2, 3};

TEST(Inertia, AQuarterTurnExchangesTheMomentsOfInertia) {
  modal::MassProperties mass;
  mass.inertia_kg_m2 = {1, 2, 3};
  mass.orientation = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};  // 90 degrees about z: the first axis lies along y
  const Matrix3 tensor = inertia_tensor(mass);
  EXPECT_NEAR(tensor[0][0], 2, 1e-12);
  EXPECT_NEAR(tensor[1][1], 1, 1e-12);
  EXPECT_NEAR(tensor[2][2], 3, 1e-12);
  EXPECT_NEAR(tensor[0][1], 0, 1e-12);
}

TEST(Inertia, AnEighthTurnCouplesTheAxesOfInertia) {
  // By hand: R diag(1, 3, 5) R^T for 45 degrees about z is {{2, -1, 0}, {-1, 2, 0}, {0, 0, 5}}.
  modal::MassProperties mass;
  mass.inertia_kg_m2 = {1, 3, 5};
  mass.orientation = {0, 0, std::sin(M_PI / 8), std::cos(M_PI / 8)};
  const Matrix3 tensor = inertia_tensor(mass);
  EXPECT_NEAR(tensor[0][0], 2, 1e-12);
  EXPECT_NEAR(tensor[0][1], -1, 1e-12);
  EXPECT_NEAR(tensor[1][0], -1, 1e-12);
}

TEST(Solid, ASolidTakesMassAndSizeFromTheBank) {
  const modal::Bank bank = test::box_bank(kSize, 6, kCenter);
  const auto solid = make_solid(test::body_of("a", ShapeType::box, {}), &bank, {.density = 2});
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_DOUBLE_EQ(solid->mass.mass_kg, 12) << "the density scale";
  EXPECT_NEAR(solid->shape.size_m.y, 0.2, 1e-6);
  EXPECT_NEAR(length(solid->shape.center_m), 0, 1e-6) << "relative to the centre of mass";
  const auto sphere = make_solid(test::body_of("a", ShapeType::sphere, {}), &bank);
  ASSERT_TRUE(sphere);
  EXPECT_NEAR(sphere->shape.radius_m, 0.5 * length(kSize), 1e-6);
  const auto convex = make_solid(test::body_of("a", ShapeType::convex, {}), &bank);
  ASSERT_TRUE(convex);
  EXPECT_EQ(convex->shape.points.size(), 8u);
}

TEST(Solid, ASolidOfTwiceTheSizeIsTheSolidOfABankOfThatSize) {
  const modal::Bank bank = test::box_bank(kSize, 6, kCenter), large = test::box_bank(2 * kSize, 48, 2 * kCenter);
  for (const ShapeType type : {ShapeType::box, ShapeType::sphere, ShapeType::convex}) {
    const BodyDescription body = test::body_of("a", type, {});
    const auto scaled = make_solid(body, &bank, {.density = 3, .size = 2}), baked = make_solid(body, &large);
    ASSERT_TRUE(scaled && baked);
    EXPECT_NEAR(scaled->mass.mass_kg, 3 * baked->mass.mass_kg, 1e-9);
    EXPECT_NEAR(length(scaled->mass.center_m - baked->mass.center_m), 0, 1e-6);
    EXPECT_NEAR(length(scaled->shape.center_m - baked->shape.center_m), 0, 1e-6);
    EXPECT_NEAR(length(scaled->shape.size_m - baked->shape.size_m), 0, 1e-6);
    EXPECT_NEAR(scaled->shape.radius_m, baked->shape.radius_m, 1e-6);
    EXPECT_EQ(scaled->shape.points.size(), baked->shape.points.size());
  }
  const auto tensor = [&](double size) {
    return make_solid(test::body_of("a", ShapeType::box, {}), &bank, {.size = size})->mass.inertia_kg_m2;
  };
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(tensor(2)[i][i], 32 * tensor(1)[i][i], 1e-9);
}

TEST(Solid, ASolidsOwnDensityBeatsTheBank) {
  BodyDescription body = test::body_of("a", ShapeType::box, {});
  body.density_kg_m3 = 500;
  const modal::Bank bank = test::box_bank(kSize, 6);
  const auto solid = make_solid(body, &bank);
  ASSERT_TRUE(solid);
  EXPECT_NEAR(solid->mass.mass_kg, 500 * 0.006, 1e-6);
}

void expect_refused(const BodyDescription& body, const modal::Bank* bank, const std::string& word) {
  const auto solid = make_solid(body, bank);
  ASSERT_FALSE(solid) << word;
  EXPECT_NE(solid.error().message.find(word), std::string::npos) << solid.error().message;
}

TEST(Solid, ASolidThatWouldEndTheProcessInOdeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const BodyDescription body = test::body_of("a", ShapeType::box, {});
  const modal::Bank good = test::box_bank(kSize, 6);
  modal::Bank bank = good;
  bank.mass->mass_kg = 0;
  expect_refused(body, &bank, "mass");
  bank.mass->mass_kg = nan;
  expect_refused(body, &bank, "mass");
  bank = good;
  bank.mass->inertia_kg_m2.y = 0;
  expect_refused(body, &bank, "degenerate");
  bank.mass->inertia_kg_m2.y = nan;
  expect_refused(body, &bank, "degenerate");
  bank = good;
  bank.mass->orientation = {0, 0, 0, 0};
  expect_refused(body, &bank, "degenerate");
  bank = good;
  bank.mass.reset();
  expect_refused(body, &bank, "massProperties");
  bank = good;
  bank.positions.clear();
  expect_refused(body, &bank, "no surface");
  bank = good;
  bank.triangles.clear();
  expect_refused(test::body_of("a", ShapeType::trimesh, {}), &bank, "no triangles");
  BodyDescription silent = body;
  silent.shape.size_m = {0.1, nan, 0.1};
  expect_refused(silent, nullptr, "size");
  silent.shape.size_m = {0.1, 0.1, 0.1};
  expect_refused(silent, nullptr, "density_kg_m3");
  silent.density_kg_m3 = nan;
  expect_refused(silent, nullptr, "density");
}

}  // namespace
}  // namespace ringdown::scene::solid_test
