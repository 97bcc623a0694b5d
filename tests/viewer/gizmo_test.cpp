// The gizmo's handles: what a drag along a known path of the picture does, by projecting that path.
#include "clients/viewer/render/gizmo.h"

#include "clients/viewer/render/placing.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace ringdown::viewer {
namespace {

constexpr int kWide = 900, kHigh = 600;
const glm::vec3 kCentre{0.3F, -0.2F, 0.5F};

struct Picture {
  Camera camera = Camera::from({1.3F, -2, 1.6F}, {0, 0, 0.3F});
  Gizmo gizmo{kCentre, camera, kWide, kHigh};
  [[nodiscard]] glm::vec2 of(glm::vec3 point) const {
    const auto at = camera.project(point, kWide, kHigh);
    EXPECT_TRUE(at);
    return at.value_or(glm::vec2(0));
  }
};

glm::vec3 axis(int number) { return {number == 0 ? 1 : 0, number == 1 ? 1 : 0, number == 2 ? 1 : 0}; }

TEST(Gizmo, ADragAlongAnAxisMovesByItsLengthAlongThatAxisOnly) {
  const Picture picture;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 from = kCentre + 0.1F * axis(k), to = kCentre + 0.35F * axis(k);
    const auto change =
        picture.gizmo.change_by(kHandles[static_cast<std::size_t>(k)], picture.of(from), picture.of(to));
    EXPECT_LT(glm::distance(change.move_m, 0.25F * axis(k)), 1e-4F) << k;
    EXPECT_EQ(change.size, 1);
    EXPECT_EQ(change.turn, glm::quat(1, 0, 0, 0));
  }
}

TEST(Gizmo, ADragAlongARingTurnsByItsAngle) {
  const Picture picture;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 a = axis((k + 1) % 3), b = axis((k + 2) % 3);
    const auto on_ring = [&](float angle) {
      return picture.of(kCentre + 0.2F * (std::cos(angle) * a + std::sin(angle) * b));
    };
    const auto change =
        picture.gizmo.change_by(kHandles[static_cast<std::size_t>(3 + k)], on_ring(0.4F), on_ring(1.1F));
    EXPECT_NEAR(change.turn.w, std::cos(0.35F), 1e-4) << k;
    EXPECT_NEAR((change.turn.x + change.turn.y + change.turn.z), std::sin(0.35F), 1e-4) << k;
    EXPECT_EQ(change.move_m, glm::vec3(0));
  }
}

// The camera stands in the plane of the ring about x: the near side moves up when the body turns about -x.
TEST(Gizmo, ARingSeenFromItsEdgeTurnsWithTheMouse) {
  const Camera camera = Camera::from({0, -2, 0}, {0, 0, 0});
  const Gizmo gizmo({0, 0, 0}, camera, kWide, kHigh);
  const auto change = gizmo.change_by(Handle::turn_x, {kWide / 2, kHigh / 2}, {kWide / 2, kHigh / 2 - 20});
  const glm::vec3 near_side = change.turn * glm::vec3(0, -1, 0);
  EXPECT_GT(near_side.z, 0.1F);
  EXPECT_NEAR(glm::length(near_side), 1, 1e-5);
}

TEST(Gizmo, ADragAwayFromTheMiddleEnlarges) {
  const Picture picture;
  const glm::vec2 middle = picture.of(kCentre);
  EXPECT_NEAR(picture.gizmo.change_by(Handle::size, middle + glm::vec2(40, 30), middle + glm::vec2(80, 60)).size, 2,
              1e-5);
  EXPECT_NEAR(picture.gizmo.change_by(Handle::size, middle + glm::vec2(0, 50), middle).size, 1 / Gizmo::kMaxFactor,
              1e-6);
}

TEST(Gizmo, EachHandleIsGrippedOnItsLineAndNothingBeside) {
  const Picture picture;
  for (const Handle handle : kHandles) {
    const auto line = picture.gizmo.line_of(handle);
    ASSERT_GE(line.size(), 2u);
    EXPECT_EQ(picture.gizmo.handle_at(line.back() + glm::vec2(1, 0)), handle) << static_cast<int>(handle);
  }
  EXPECT_FALSE(picture.gizmo.handle_at({5, 5}));
  EXPECT_FALSE(picture.gizmo.handle_at(picture.of(kCentre))) << "the body itself can be clicked";
}

TEST(Gizmo, BehindTheCameraNothingIsDrawnOrGripped) {
  const Camera camera = Camera::from({0, -2, 0}, {0, 0, 0});
  const Gizmo gizmo({0, -5, 0}, camera, kWide, kHigh);
  for (const Handle handle : kHandles) EXPECT_TRUE(gizmo.line_of(handle).empty());
  EXPECT_FALSE(gizmo.handle_at({kWide / 2, kHigh / 2}));
}

TEST(Angles, AreThoseOfTurnsOneAfterTheOther) {
  const Matrix3 turned = to_matrix(rotation_of({90, 0, 0}));
  EXPECT_LT(length(turned * Vec3{1, 0, 0} - Vec3{0, 1, 0}), 1e-12) << "heading turns x to y";
  EXPECT_LT(length(to_matrix(rotation_of({0, 90, 0})) * Vec3{1, 0, 0} - Vec3{0, 0, -1}), 1e-12);
  EXPECT_LT(length(to_matrix(rotation_of({0, 0, 90})) * Vec3{0, 1, 0} - Vec3{0, 0, 1}), 1e-12);
  EXPECT_LT(length(to_matrix(rotation_of({90, 90, 0})) * Vec3{0, 0, 1} - Vec3{0, 1, 0}), 1e-12) << "first the tilt";
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const Angles angles = {180 * any(random), 89 * any(random), 180 * any(random)};
    const Angles again = angles_of(rotation_of(angles));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(again[k], angles[k], 1e-6);
  }
}

TEST(Placing, ABodyTurnsAboutTheCentreAndMoves) {
  const Vec3 centre{1, 0, 0};
  const auto quarter = glm::angleAxis(std::numbers::pi_v<float> / 2, glm::vec3(0, 0, 1));
  const ringdown::Pose pose = changed({{2, 0, 0}, {}}, centre, {.move_m = {0, 0, 3}, .turn = quarter});
  EXPECT_LT(length(pose.position_m - Vec3{1, 1, 3}), 1e-6);
  EXPECT_LT(length(to_matrix(pose.rotation) * Vec3{1, 0, 0} - Vec3{0, 1, 0}), 1e-6);
}

}  // namespace
}  // namespace ringdown::viewer
