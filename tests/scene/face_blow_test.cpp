// A body that may break lands on a face: it is judged by all of the face, of which a simulation finds a few points.
#include "engine/scene/contact/contact_sounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace ringdown::scene {
namespace {

constexpr std::size_t kCorners = 24;
constexpr double kRadius_m = 0.04, kMass_kg = 0.2, kFall_m_s = 2;

// A glass with a round foot, 5 cm below its centre of mass. Corners of the rim are far from the floor.
ContactSide glass() {
  ContactSide side;
  side.mass = RigidMass{kMass_kg, {}, {}};
  side.mass->inertia_kg_m2 = to_matrix(Rotation{});
  side.object = 3;
  side.breaks = true;
  for (std::size_t k = 0; k < kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kCorners;
    side.corners_m.push_back({kRadius_m * std::cos(angle), kRadius_m * std::sin(angle), -0.05});
    side.corners_m.push_back({kRadius_m * std::cos(angle), kRadius_m * std::sin(angle), 0.05});
  }
  return side;
}

// The blows of a fall onto a floor at z = 0, found at these corners of the foot.
BodyBlows landing(const std::vector<std::size_t>& found, const Motion& motion) {
  SceneDescription scene;
  ContactSounds sounds(scene);
  const ContactSide side = glass();
  sounds.set_side(0, side);
  StaticDescription floor;
  sounds.set_side(kFirstStatic, side_of(floor));
  std::optional<BodyBlows> judged;
  sounds.judge_by([&](BodyId body, BodyId /*other*/, const BodyBlows& blows) {
    EXPECT_EQ(body, 0u);
    judged = blows;
    return std::optional<double>();
  });
  const MotionPair motions{motion, {}};
  std::vector<ContactPoint> points;
  for (const std::size_t k : found) {
    ContactPoint point{.body = 0, .other = kFirstStatic, .normal = {0, 0, 1}, .motions = &motions};
    point.point_m = motion.position_m + side.corners_m[2 * k];
    point.impulse_ns = {0, 0, kMass_kg * kFall_m_s / static_cast<double>(found.size())};
    point.approach_m_s = -motion.velocity_at(point.point_m).z;
    points.push_back(point);
  }
  sounds.process(points, {}, 0, {});
  return judged.value();
}

TEST(FaceBlow, ThreePointsOfAFootStandForItsRing) {
  const Motion fall{.position_m = {1, 2, 0.05}, .velocity_m_s = {0, 0, -kFall_m_s}};
  const BodyBlows blows = landing({0, 8, 16}, fall);
  EXPECT_EQ(blows.strikes.size(), 3u);
  EXPECT_NEAR(blows.pressed_ns, kMass_kg * kFall_m_s, 1e-12);
  ASSERT_EQ(blows.meeting.points.size(), 12u);
  ASSERT_EQ(blows.meeting.other_per_kg.size(), 144u);
  Vec3 sum;
  for (const breaking::MeetingPoint& point : blows.meeting.points) {
    sum = sum + point.point_m;
    EXPECT_NEAR(std::hypot(point.point_m.x, point.point_m.y), kRadius_m, 1e-12);
    EXPECT_NEAR(point.point_m.z, -0.05, 1e-12);
    EXPECT_NEAR(point.closing_m_s, kFall_m_s, 1e-12);
    EXPECT_NEAR(point.gap_m, 0, 1e-12);
  }
  EXPECT_LT(std::hypot(sum.x, sum.y) / 12, 0.2 * kRadius_m) << "all around";
  EXPECT_LT(blows.meeting.spacing_m, kRadius_m);
  EXPECT_GT(blows.meeting.spacing_m, kRadius_m / 4);
}

TEST(FaceBlow, ATurningBodyMeetsTheFloorFasterOnOneSide) {
  const Motion turning{.position_m = {0, 0, 0.05}, .velocity_m_s = {0, 0, -kFall_m_s}, .spin_rad_s = {10, 0, 0}};
  for (const breaking::MeetingPoint& point : landing({0, 8, 16}, turning).meeting.points)
    EXPECT_NEAR(point.closing_m_s, kFall_m_s - 10 * point.point_m.y, 1e-12);
}

TEST(FaceBlow, PointsThatSpanNoFaceStandForThemselves) {
  const Motion fall{.position_m = {0, 0, 0.05}, .velocity_m_s = {0, 0, -kFall_m_s}};
  const BodyBlows blows = landing({0, 8}, fall);
  EXPECT_EQ(blows.meeting.points.size(), 2u);
  EXPECT_EQ(blows.meeting.spacing_m, 0);
}

}  // namespace
}  // namespace ringdown::scene
