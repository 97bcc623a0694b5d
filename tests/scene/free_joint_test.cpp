// Free joints, which leave any axes to move along and to turn about, against the mechanics of bodies, springs and
// motors.
#include "engine/scene/rotation.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace ringdown::scene::free_joint_test {
namespace {

using test::box_bank;
using test::sounding;
using test::world_of;

constexpr Vec3 kRod{0.02, 0.03, 0.4};
constexpr double kMass = 0.5, kG = 9.81, kDegree = std::numbers::pi / 180;

AxesLimit held(bool turns, std::size_t axis) { return {.turns = turns, .axes = {axis}, .low = 0, .high = 0}; }

std::vector<AxesLimit> no_turn() { return {held(true, 0), held(true, 1), held(true, 2)}; }
std::vector<AxesLimit> no_way() { return {held(false, 0), held(false, 1), held(false, 2)}; }

// A rod whose middle lies at z = 1, and a free joint at a place of the world.
SceneDescription with_joint(Vec3 anchor_m, std::vector<AxesLimit> limits, std::vector<AxisDrive> drives = {}) {
  BodyDescription rod = test::body_of("rod", ShapeType::box, {0, 0, 1});
  SceneDescription scene = test::scene_of({rod});
  scene.step_s = 0.001;
  JointDescription joint{.name = "joint", .type = JointType::free, .body = "rod", .anchor_m = anchor_m};
  joint.end.position_m = anchor_m;
  joint.limits = std::move(limits);
  joint.drives = std::move(drives);
  scene.joints = {joint};
  return scene;
}

World world_with(const SceneDescription& scene) {
  return world_of(scene, {sounding("rod", 0, box_bank(kRod, kMass)), sounding("other", 1, box_bank(kRod, 2 * kMass))});
}

BodyState rod(const World& world) { return world.bodies()[0]; }
double turned(const World& world) { return length(to_rotation_vector(rod(world).rotation)); }

void follow(World& world, double seconds, const std::function<void()>& look) {
  for (const double end = world.time_s() + seconds; world.time_s() < end - 1e-9;) {
    world.step();
    look();
  }
}

// The mean time between upward crossings of zero in the next seconds.
double period(World& world, double seconds, const std::function<double()>& value) {
  std::vector<double> crossings;
  double last = value();
  follow(world, seconds, [&] {
    const double now = value();
    if (last < 0 && now >= 0) crossings.push_back(world.time_s() - world.step_s() * now / (now - last));
    last = now;
  });
  return (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

TEST(FreeJoint, ABodyThatMayNotTurnFallsAsItWouldAndStaysUpright) {
  std::vector<AxesLimit> limits = no_turn();
  limits.push_back(held(true, 0));  // said twice, a lock is one lock
  SceneDescription scene = with_joint({0, 0, 1}, limits);
  scene.bodies[0].velocity_m_s = {0.4, -0.3, 0.5};
  scene.bodies[0].spin_rad_s = {0, 2, 0};
  World world = world_with(scene);
  test::run_all(world, 0.3);
  EXPECT_LT(length(rod(world).center_m - Vec3{0.12, -0.09, 1 + 0.15 - 0.5 * kG * 0.09}), 1e-4);
  EXPECT_LT(turned(world), 1e-6);
}

// The body lands with one lower edge on the edge of a block, which would turn it over.
TEST(FreeJoint, ABodyThatMayNotTurnStandsOnItsEdge) {
  SceneDescription scene = with_joint({0, 0, 1}, no_turn());
  StaticDescription block{.name = "block", .type = StaticType::box, .size_m = {0.2, 0.2, 0.2}};
  block.position_m = {0.105, 0, 0.6};
  scene.statics.push_back(block);
  World world = world_with(scene);
  double farthest = 0;
  follow(world, 1, [&] { farthest = std::max(farthest, turned(world)); });
  EXPECT_LT(farthest, 1e-3);
  EXPECT_NEAR(rod(world).center_m.z, 0.7 + kRod.z / 2, 1e-3);
  scene.joints.clear();
  World loose = world_with(scene);
  test::run_all(loose, 1);
  EXPECT_GT(turned(loose), 0.5) << "without the joint it falls over";
}

TEST(FreeJoint, ABallJointWithAConeSwingsToItsAngleAndNoFarther) {
  constexpr double kWidth = 20 * kDegree;
  for (const double way : {0.0, 1.0, 2.5, 4.0, 5.5}) {
    std::vector<AxesLimit> limits = no_way();
    limits.push_back({.turns = true, .axes = {0, 1}, .high = kWidth});  // about x and y: a cone around z
    World world = world_with(with_joint({0, 0, 1 + kRod.z / 2}, limits));
    ASSERT_TRUE(world.push(0, {std::cos(way), std::sin(way), 0}));
    double farthest = 0;
    follow(world, 0.5, [&] {
      const Vec3 axis = to_matrix(rod(world).rotation) * Vec3{0, 0, 1};
      farthest = std::max(farthest, std::atan2(std::hypot(axis.x, axis.y), axis.z));
    });
    EXPECT_NEAR(farthest, kWidth, 0.1 * kDegree) << way;
    EXPECT_LT(length(rod(world).center_m + to_matrix(rod(world).rotation) * Vec3{0, 0, kRod.z / 2} - Vec3{0, 0, 1.2}),
              1e-3);
  }
}

TEST(FreeJoint, ATwistLimitHoldsHoweverTheBodySwings) {
  std::vector<AxesLimit> limits = no_way();
  limits.push_back({.turns = true, .axes = {2}, .low = -0.3, .high = 0.5});
  for (const double spin : {8.0, -8.0}) {
    SceneDescription scene = with_joint({0, 0, 1 + kRod.z / 2}, limits);
    scene.bodies[0].spin_rad_s = {0, 0, spin};
    World world = world_with(scene);
    ASSERT_TRUE(world.push(0, {0.2, 0.1, 0}));
    double low = 0, high = 0;
    follow(world, 0.5, [&] {
      const Rotation q = rod(world).rotation;
      const double twist = std::remainder(2 * std::atan2(q.z, q.w), 2 * std::numbers::pi);
      low = std::min(low, twist), high = std::max(high, twist);
    });
    EXPECT_GT(low, -0.3 - 0.01);
    EXPECT_LT(high, 0.5 + 0.01);
    EXPECT_NEAR(spin > 0 ? high : low, spin > 0 ? 0.5 : -0.3, 0.01);
  }
}

// With 2 N on 0.5 kg the speed grows by 4 m/s in a second.
TEST(FreeJoint, AMotorSpeedsABodyUpByItsForceAndHoldsItsSpeed) {
  SceneDescription scene =
      with_joint({0, 0, 1}, no_turn(), {{.axis = 0, .drive = {.damping = 1e6, .speed = 0.8, .max = 2}}});
  scene.gravity_m_s2 = {};
  World world = world_with(scene);
  test::run_all(world, 0.1);
  EXPECT_NEAR(rod(world).velocity_m_s.x, 0.4, 0.005);
  test::run_all(world, 0.4);
  EXPECT_NEAR(rod(world).velocity_m_s.x, 0.8, 1e-4);
  EXPECT_LT(turned(world), 1e-6);
}

TEST(FreeJoint, AMotorAboutAnAxisReachesItsSpeed) {
  SceneDescription scene =
      with_joint({0, 0, 1}, no_way(), {{.turns = true, .axis = 1, .drive = {.damping = 10, .speed = -3}}});
  scene.gravity_m_s2 = {};
  World world = world_with(scene);
  test::run_all(world, 0.5);
  EXPECT_LT(length(rod(world).spin_rad_s - Vec3{0, -3, 0}), 1e-3);
}

TEST(FreeJoint, AMotorAtACreepDoesNotFallAsleep) {
  SceneDescription scene =
      with_joint({0, 0, 1}, no_turn(), {{.axis = 0, .drive = {.damping = 1e6, .speed = 0.001, .max = 100}}});
  scene.bodies[0].position_m = {0, 0, kRod.z / 2};
  scene.bodies[0].surface.friction = 0.4;
  World world = world_with(scene);
  test::run_all(world, 4);
  EXPECT_NEAR(rod(world).center_m.x, 0.004, 1e-4);
}

TEST(FreeJoint, SpringsSwingWithThePeriodsOfTheirMassAndMoment) {
  constexpr double kStiffness = 40, kTorsion = 0.02;
  SceneDescription scene = with_joint({0, 0, 1}, {}, {{.axis = 1, .drive = {.stiffness = kStiffness, .target = 0.05}}});
  scene.gravity_m_s2 = {};
  World world = world_with(scene);
  const double expected = 2 * std::numbers::pi * std::sqrt(kMass / kStiffness);
  EXPECT_NEAR(period(world, 5, [&] { return rod(world).center_m.y - 0.05; }) / expected, 1, 0.002);
  EXPECT_NEAR(rod(world).center_m.x, 0, 1e-9);

  scene.joints[0].drives = {{.turns = true, .axis = 2, .drive = {.stiffness = kTorsion, .target = 0.2}}};
  World twisting = world_with(scene);
  const double moment = kMass * (kRod.x * kRod.x + kRod.y * kRod.y) / 12;
  const double twist_s = 2 * std::numbers::pi * std::sqrt(moment / kTorsion);
  const auto twist = [&] { return 2 * std::atan2(rod(twisting).rotation.z, rod(twisting).rotation.w) - 0.2; };
  EXPECT_NEAR(period(twisting, 1, twist) / twist_s, 1, 0.01);
}

TEST(FreeJoint, ALeashLetsABodyFallToItsEnd) {
  for (const double stiffness : {0.0, 300.0}) {
    World world = world_with(
        with_joint({0, 0, 1}, {{.axes = {0, 1, 2}, .high = 0.3, .stiffness = stiffness, .damping = 0.1 * stiffness}}));
    test::run_all(world, 0.2);
    EXPECT_NEAR(rod(world).center_m.z, 1 - 0.5 * kG * 0.04, 1e-3);
    test::run_all(world, 4);
    EXPECT_NEAR(rod(world).center_m.z, 0.7 - (stiffness > 0 ? kMass * kG / stiffness : 0), 1e-3);
  }
}

// A tube about the x axis: along x the body slides, across it the body comes to the wall and stays.
TEST(FreeJoint, ALimitOverTwoAxesIsATube) {
  std::vector<AxesLimit> limits = no_turn();
  limits.push_back({.axes = {1, 2}, .high = 0.1});
  SceneDescription scene = with_joint({0, 0, 1}, limits);
  scene.bodies[0].velocity_m_s = {0.5, 0, 0};
  World world = world_with(scene);
  test::run_all(world, 1);
  EXPECT_NEAR(rod(world).center_m.x, 0.5, 1e-3);
  EXPECT_NEAR(rod(world).center_m.y, 0, 1e-3);
  EXPECT_NEAR(rod(world).center_m.z, 0.9, 1e-3);
}

// The force of a row acts on both bodies in one line, wherever their centres are.
TEST(FreeJoint, MotorsBetweenTwoBodiesKeepMomentumAndAngularMomentum) {
  SceneDescription scene = with_joint({0.1, 0.05, 1.1}, {{.axes = {1}, .low = -0.02, .high = 0.02}},
                                      {{.axis = 0, .drive = {.damping = 3, .speed = 0.5}},
                                       {.turns = true, .axis = 2, .drive = {.damping = 0.01, .speed = 2}}});
  BodyDescription other = test::body_of("other", ShapeType::box, {0.25, 0.1, 1.3});
  scene.bodies.push_back(other);
  scene.objects.push_back({.name = "other"});
  scene.joints[0].other = "other";
  scene.joints[0].collides = false;
  scene.gravity_m_s2 = {};
  scene.bodies[0].velocity_m_s = {0, 0.3, 0};
  World world = world_with(scene);
  const auto momenta = [&] {
    Vec3 linear, angular;
    for (const BodyState& body : world.bodies()) {
      const double mass = body.name == "rod" ? kMass : 2 * kMass;
      const Matrix3 turn = to_matrix(body.rotation);
      const Vec3 inner = transpose(turn) * body.spin_rad_s;
      const double k = mass / 12;
      const Vec3 own{k * (kRod.y * kRod.y + kRod.z * kRod.z) * inner.x,
                     k * (kRod.x * kRod.x + kRod.z * kRod.z) * inner.y,
                     k * (kRod.x * kRod.x + kRod.y * kRod.y) * inner.z};
      linear = linear + mass * body.velocity_m_s;
      angular = angular + turn * own + mass * cross(body.center_m, body.velocity_m_s);
    }
    return std::pair(linear, angular);
  };
  const auto [linear, angular] = momenta();
  test::run_all(world, 0.4);
  const auto [linear_after, angular_after] = momenta();
  EXPECT_LT(length(linear_after - linear), 1e-9);
  EXPECT_LT(length(angular_after - angular), 2e-4);
  EXPECT_GT(std::abs(world.bodies()[1].velocity_m_s.x), 0.02) << "the motor has moved both";
}

TEST(FreeJoint, ItsFramesStayThroughANewBank) {
  std::vector<AxesLimit> limits = no_way();
  limits.push_back({.turns = true, .axes = {0, 1}, .high = 0.3});
  World world = world_with(with_joint({0, 0, 1 + kRod.z / 2}, limits));
  ASSERT_TRUE(world.push(0, {0.05, 0, 0}));
  test::run_all(world, 0.2);
  ASSERT_TRUE(world.set_object(sounding("rod", 0, box_bank(kRod, 3 * kMass))));
  ASSERT_TRUE(world.push(0, {3, 0, 0}));
  double farthest = 0;
  follow(world, 0.5, [&] { farthest = std::max(farthest, turned(world)); });
  EXPECT_NEAR(farthest, 0.3, 0.003);
}

TEST(FreeJoint, AsATextItIsReadAgainBitForBit) {
  SceneDescription scene =
      with_joint({0.1, 0.2, 1}, no_turn(), {{.turns = true, .axis = 2, .drive = {.stiffness = 3}}});
  JointDescription& joint = scene.joints[0];
  joint.limits.push_back({.axes = {2, 0}, .low = 0.1, .high = 0.5, .stiffness = 7, .damping = 0.3});
  joint.rotation = about({1, 2, 3}, 0.7);
  joint.end = {{0.3, 0.1, 0.9}, about({0, 1, 1}, -0.2)};
  joint.frame_of_body = true;
  scene.objects.clear();
  scene.bodies[0].object.clear();
  scene.bodies[0].shape.size_m = kRod;
  scene.bodies[0].density_kg_m3 = 1000;
  const std::string text = to_toml(scene);
  const auto again = parse_scene(text, "x.toml", {});
  ASSERT_TRUE(again) << again.error().message << "\n" << text;
  EXPECT_EQ(to_toml(*again), text);
  EXPECT_EQ(again->joints[0].limits, joint.limits);
  EXPECT_EQ(again->joints[0].drives, joint.drives);
  EXPECT_EQ(again->joints[0].end, joint.end);
  EXPECT_EQ(again->joints[0].rotation, joint.rotation);
}

TEST(FreeJoint, WrongLimitsAreRefusedWithASentence) {
  const auto refused = [](const std::string& word, const std::function<void(JointDescription&)>& spoil) {
    SceneDescription scene = with_joint({0, 0, 1}, no_turn(), {{.axis = 0}});
    spoil(scene.joints[0]);
    const auto world = World::create(scene, std::vector{sounding("rod", 0, box_bank(kRod, kMass))}, 48000);
    ASSERT_FALSE(world) << word;
    EXPECT_NE(world.error().message.find(word), std::string::npos) << world.error().message;
  };
  refused("one to three", [](auto& joint) { joint.limits[0].axes = {}; });
  refused("one to three", [](auto& joint) { joint.limits[0].axes = {1, 1}; });
  refused("one to three", [](auto& joint) { joint.limits[0].axes = {3}; });
  refused("low end", [](auto& joint) { joint.limits[0].low = 1; });
  refused("limits.high", [](auto& joint) { joint.limits[0].high = std::nan(""); });
  refused("limits.stiffness", [](auto& joint) { joint.limits[0].stiffness = -1; });
  refused("axes 0, 1 and 2", [](auto& joint) { joint.drives[0].axis = 3; });
  refused("drive.most", [](auto& joint) { joint.drives[0].drive.max = -1; });
  refused("more than", [](auto& joint) { joint.limits.resize(kMaxJointParts + 1, joint.limits[0]); });
  refused("quaternion", [](auto& joint) { joint.rotation.w = 0; });
}

}  // namespace
}  // namespace ringdown::scene::free_joint_test
