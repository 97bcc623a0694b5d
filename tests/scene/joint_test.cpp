// Joints against the mechanics of pendulums, and emitters against their timetable.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace ringdown::scene::joint_test {
namespace {

using test::body_of;
using test::box_bank;
using test::sounding;
using test::world_of;

constexpr Vec3 kRod{0.02, 0.02, 0.4};
constexpr double kMass = 0.5, kG = 9.81;

// A rod that hangs from its upper end at z = 1, deflected about y.
SceneDescription pendulum(JointType type, double deflection) {
  BodyDescription rod = body_of("rod", ShapeType::box, {});
  rod.rotation = about({0, 1, 0}, deflection);
  rod.position_m = Vec3{0, 0, 1} - to_matrix(rod.rotation) * Vec3{0, 0, kRod.z / 2};
  SceneDescription scene = test::scene_of({rod});
  scene.step_s = 0.001;
  scene.joints = {{.name = "hook", .type = type, .body = "rod", .anchor_m = {0, 0, 1}, .axis = {0, 1, 0}}};
  return scene;
}

World world_with(const SceneDescription& scene) { return world_of(scene, {sounding("rod", 0, box_bank(kRod, kMass))}); }

double angle(const World& world) {
  const Vec3 down = to_matrix(world.bodies()[0].rotation) * Vec3{0, 0, -1};
  return std::atan2(-down.x, -down.z);
}

Vec3 hook(const World& world) {
  const BodyState rod = world.bodies()[0];
  return rod.center_m + to_matrix(rod.rotation) * Vec3{0, 0, kRod.z / 2};
}

// The mean of the periods of the next seconds.
double period(World& world, double seconds) {
  std::vector<double> crossings;
  for (double last = angle(world), end = world.time_s() + seconds; world.time_s() < end;) {
    world.step();
    const double now = angle(world);
    if (last < 0 && now >= 0) crossings.push_back(world.time_s() + world.step_s() * now / (last - now));
    last = now;
  }
  return (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

TEST(Joint, ARodSwingsWithThePeriodOfItsMoment) {
  // T = 2 pi sqrt(I / (m g l/2)), I about the end: m (l^2 + w^2) / 12 + m l^2 / 4.
  const double moment = kMass * ((0.16 + 0.0004) / 12 + 0.04),
               expected = 2 * M_PI * std::sqrt(moment / (kMass * kG * 0.2));
  for (const JointType type : {JointType::hinge, JointType::ball}) {
    World world = world_with(pendulum(type, 0.05));
    EXPECT_NEAR(period(world, 5) / expected, 1, 0.003) << static_cast<int>(type);
    EXPECT_LT(length(hook(world) - Vec3{0, 0, 1}), 0.001) << "it hangs where it was hung";
  }
}

TEST(Joint, ABodyThatComesBackHangsFromItsJoint) {
  World world = world_with(pendulum(JointType::hinge, 0.05));
  test::run_all(world, 0.3);
  ASSERT_TRUE(world.remove(0));
  test::run_all(world, 0.3);
  ASSERT_TRUE(world.restore(0));
  test::run_all(world, 3);
  EXPECT_LT(length(hook(world) - Vec3{0, 0, 1}), 0.001);
}

TEST(Joint, ASoftLimitBearsAWeightAsASpringDoes) {
  SceneDescription scene = pendulum(JointType::slider, 0);
  scene.joints[0].axis = {0, 0, 1};
  scene.joints[0].low_m = scene.joints[0].high_m = 0;
  World hard = world_with(scene);
  const double before_m = hook(hard).z;
  test::run_all(hard, 3);
  EXPECT_NEAR(hook(hard).z, before_m, 1e-4);
  scene.joints[0].limit_stiffness = 200;
  scene.joints[0].limit_damping = 5;
  World soft = world_with(scene);
  test::run_all(soft, 3);
  EXPECT_NEAR(before_m - hook(soft).z, kMass * kG / 200, 1e-4);
}

TEST(Joint, AHingeTurnsAboutItsAxisOnlyAndABallAboutAll) {
  for (const JointType type : {JointType::hinge, JointType::ball}) {
    World world = world_with(pendulum(type, 0.0));
    ASSERT_TRUE(world.push(0, {0, 0.2, 0}));
    test::run_all(world, 0.3);
    const double sideways = std::abs(world.bodies()[0].center_m.y);
    EXPECT_EQ(sideways > 0.01, type == JointType::ball) << sideways;
  }
}

TEST(Joint, LimitsOfJointsHoldByTheRightHand) {
  SceneDescription scene = pendulum(JointType::hinge, 0.0);
  scene.joints[0].low_degrees = -10;
  scene.joints[0].high_degrees = 20;
  for (const double push : {1.0, -1.0}) {  // towards +x it turns about y by less than nothing
    World world = world_with(scene);
    ASSERT_TRUE(world.push(0, {push, 0, 0}));
    double farthest = 0;
    while (world.time_s() < 0.1) {
      world.step();
      farthest = push > 0 ? std::min(farthest, angle(world)) : std::max(farthest, angle(world));
    }
    EXPECT_NEAR(farthest * 180 / M_PI, push > 0 ? -10 : 20, 0.5);
  }
}

TEST(Joint, FrictionBringsAJointToRest) {
  SceneDescription scene = pendulum(JointType::hinge, 0.3);
  scene.joints[0].friction_nm = 0.02;
  World world = world_with(scene);
  test::run_all(world, 10);
  EXPECT_EQ(world.bodies()[0].velocity_m_s, (Vec3{}));
  // Friction can hold m g l/2 sin(angle) up to its torque.
  EXPECT_LT(std::abs(std::sin(angle(world))), 0.02 / (kMass * kG * 0.2) + 0.01);
}

TEST(Joint, AJointHoldsTwoBodiesAndWaitsForTheLaterOne) {
  SceneDescription scene = pendulum(JointType::hinge, 0.2);
  BodyDescription lower = scene.bodies[0];
  lower.name = "lower";
  lower.position_m = Vec3{0, 0, 1} - to_matrix(lower.rotation) * Vec3{0, 0, 1.5 * kRod.z + 0.01};
  scene.bodies.push_back(lower);
  const Vec3 between = Vec3{0, 0, 1} - to_matrix(lower.rotation) * Vec3{0, 0, kRod.z + 0.005};
  scene.joints.push_back(
      {.name = "link", .type = JointType::ball, .body = "rod", .other = "lower", .anchor_m = between});
  World world = world_with(scene);
  test::run_all(world, 3);
  const auto bodies = world.bodies();
  const Vec3 upper_end = bodies[0].center_m - to_matrix(bodies[0].rotation) * Vec3{0, 0, kRod.z / 2 + 0.005};
  const Vec3 lower_end = bodies[1].center_m + to_matrix(bodies[1].rotation) * Vec3{0, 0, kRod.z / 2 + 0.005};
  EXPECT_LT(length(upper_end - lower_end), 0.002);
  EXPECT_LT(length(hook(world) - Vec3{0, 0, 1}), 0.002);

  scene.bodies[1].start_s = 0.5;
  World late = world_with(scene);
  test::run_all(late, 1);
  EXPECT_FALSE(late.bodies()[1].waiting);
  EXPECT_GT(late.bodies()[1].center_m.z, 0) << "it does not fall";
}

TEST(Joint, AJointStaysThroughANewBankAndGoesWithItsBody) {
  SceneDescription scene = pendulum(JointType::hinge, 0.2);
  scene.joints[0].high_degrees = 20;
  World world = world_with(scene);
  test::run_all(world, 0.2);
  const Vec3 before = hook(world);
  modal::Bank heavier = box_bank(kRod, 3 * kMass);
  ASSERT_TRUE(world.set_object(sounding("rod", 0, heavier)));
  test::run_all(world, 2);
  EXPECT_LT(length(hook(world) - before), 0.002);
  world.clear();
  EXPECT_TRUE(test::run_all(world, 0.1).empty());
}

TEST(Joint, AJointOfWhatCannotBeJoinedIsRefused) {
  const auto refused = [](const std::string& word, auto spoil) {
    SceneDescription scene = pendulum(JointType::hinge, 0);
    spoil(scene.joints[0], scene);
    const auto world = World::create(scene, std::vector{sounding("rod", 0, box_bank(kRod, kMass))}, 48000);
    ASSERT_FALSE(world) << word;
    EXPECT_NE(world.error().message.find(word), std::string::npos) << world.error().message;
  };
  refused("no body 'bob'", [](auto& joint, auto&) { joint.body = "bob"; });
  refused("no body 'bob'", [](auto& joint, auto&) { joint.other = "bob"; });
  refused("to itself", [](auto& joint, auto&) { joint.other = "rod"; });
  refused("free to move", [](auto&, auto& scene) { scene.bodies[0].fixed = true; });
  refused("axis", [](auto& joint, auto&) { joint.axis = {}; });
  refused("anchor_m", [](auto& joint, auto&) { joint.anchor_m.x = std::nan(""); });
  refused("friction_nm", [](auto& joint, auto&) { joint.friction_nm = -1; });
  refused("limits", [](auto& joint, auto&) { joint.low_degrees = 5; });
  refused("joints", [](auto& joint, auto& scene) { scene.joints.resize(kMaxJoints + 1, joint); });
}

SceneDescription rain(std::uint64_t count) {
  EmitterDescription emitter;
  emitter.name = "drop";
  emitter.every_s = 0.25;
  emitter.count = count;
  emitter.body = body_of("drop", ShapeType::sphere, {0, 0, 1});
  emitter.body.shape.radius_m = 0.01;
  emitter.body.density_kg_m3 = 2500;
  emitter.body.scatter_m = 0.3;
  emitter.body.start_s = 0.5;
  SceneDescription scene = test::scene_of({});
  scene.objects.resize(1);
  scene.objects[0].name = "drop";
  scene.emitters = {emitter};
  return scene;
}

World raining(const SceneDescription& scene) { return world_of(scene, {sounding("drop", 0, box_bank(kRod, kMass))}); }

TEST(Emitter, AnEmitterLetsItsBodiesInOneByOneScatteredFromTheSeed) {
  SceneDescription scene = rain(8);
  World world = raining(scene);
  const auto present = [&] { return std::ranges::count(world.bodies(), false, &BodyState::waiting); };
  test::run_all(world, 0.49);
  EXPECT_EQ(present(), 0);
  for (int k = 1; k <= 8; ++k) {
    test::run_all(world, 0.5 + 0.25 * (k - 1) + 0.01 - world.time_s());
    EXPECT_EQ(present(), k);
  }
  std::set<double> places;
  for (const BodyState& body : raining(scene).bodies()) places.insert(body.position_m.x);
  EXPECT_EQ(places.size(), 8u);
  EXPECT_GE(*places.begin(), -0.3);
  EXPECT_LE(*places.rbegin(), 0.3);
  EXPECT_EQ(world.bodies()[2].name, "drop-3");
  scene.seed = 9;
  EXPECT_NE(raining(scene).bodies()[0].position_m, raining(rain(8)).bodies()[0].position_m);
}

TEST(Emitter, AnEmittersBodiesCountAmongThoseOfTheScene) {
  EXPECT_EQ(raining(rain(kMaxBodies)).bodies().size(), kMaxBodies);
  SceneDescription scene = rain(kMaxBodies);
  scene.emitters.push_back(scene.emitters[0]);
  scene.emitters[1].name = "more";
  const auto world = World::create(scene, std::vector{sounding("drop", 0, box_bank(kRod, kMass))}, 48000);
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("2048 bodies"), std::string::npos) << world.error().message;
}

}  // namespace
}  // namespace ringdown::scene::joint_test
