// What lasts: sliding, rolling, resting and settling in a real scene, against mechanics.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace ringdown::scene::lasting_test {
namespace {

using synth::Event;
using test::body_of;
using test::box_bank;
using test::contacts;
using test::scene_of;
using test::sounding;
using test::world_of;

constexpr double kG = 9.81, kMass = 2;
constexpr Vec3 kSize{0.2, 0.2, 0.1};

// A box that starts to slide over the floor at `velocity`.
World slider(Vec3 velocity, double friction, double step_s = 0.001) {
  BodyDescription body = body_of("box", ShapeType::box, {0, 0, 0.05});
  body.rotation = about({0, 0, 1}, 0.7);
  body.velocity_m_s = velocity;
  SceneDescription scene = scene_of({body}, 0);
  scene.bodies[0].surface.friction = scene.statics[0].surface.friction = friction;
  scene.bodies[0].surface.texture = {4e-6, 1e-4, -2};
  scene.statics[0].surface.texture = {3e-6, 1e-4, -2};
  scene.step_s = step_s;
  return world_of(scene, {sounding("box", 3, box_bank(kSize, kMass))});
}

TEST(Sliding, SlidingIsToldWithWeightFrictionAndSpeed) {
  World world = slider({1.5, 1, 0}, 0.3);
  const auto told = contacts(world, 0.3);
  ASSERT_NEAR(static_cast<double>(told.size()), 0.3 / 0.004, 2);
  const double speed0 = std::hypot(1.5, 1);
  for (std::size_t k = 2; k < told.size(); ++k) {
    const auto& event = told[k];
    EXPECT_EQ(event.object, 3u);
    EXPECT_EQ(event.contact.number, 0u);
    const Vec3 force = to_matrix(about({0, 0, 1}, 0.7)) * event.contact.force_n;
    EXPECT_NEAR(force.z, kMass * kG, 0.02 * kMass * kG);
    EXPECT_NEAR(std::hypot(force.x, force.y), 0.3 * kMass * kG, 0.02 * 0.3 * kMass * kG) << "Coulomb";
    EXPECT_NEAR(force.x / force.y, 1.5, 0.05) << "against the motion, whatever its direction";
    const double time_s = static_cast<double>(event.frame) / 48000;
    EXPECT_NEAR(event.contact.slip_m_s, speed0 - 0.3 * kG * time_s, 0.03);
    EXPECT_LT(event.contact.roll_m_s, 0.02);
    EXPECT_NEAR(event.point_m.z, -0.05, 0.001) << "its underside";
    EXPECT_NEAR(event.contact.texture.roughness_m, 5e-6, 1e-12);
  }
}

TEST(Sliding, SlidingEndsWithForceZeroAndThenSilence) {
  World world = slider({0.5, 0, 0}, 0.3);
  const auto told = contacts(world, 2);
  ASSERT_GT(told.size(), 10u);
  EXPECT_EQ(told.back().contact.force_n, (Vec3{}));
  for (std::size_t k = 0; k + 1 < told.size(); ++k) EXPECT_NE(told[k].contact.force_n, (Vec3{})) << k;
  EXPECT_NEAR(static_cast<double>(told.back().frame) / 48000, 0.5 / (0.3 * kG), 0.015) << "when it has come to rest";
}

TEST(Sliding, SlidingStopsAfterCoulombsDistanceInEveryDirection) {
  for (const double angle : {0.0, 0.4, 0.785, 1.3}) {
    World world = slider({std::cos(angle), std::sin(angle), 0}, 0.3);
    test::run_all(world, 1);
    const Vec3 way = world.bodies()[0].position_m;
    EXPECT_NEAR(std::hypot(way.x, way.y), 1 / (2 * 0.3 * kG), 0.01 / (2 * 0.3 * kG)) << angle;
  }
}

TEST(Sliding, SlidingInLongStepsIsToldAsOftenAsInShortOnes) {
  World world = slider({3, 0, 0}, 0.3, 1.0 / 100);
  const auto told = contacts(world, 0.5);
  EXPECT_NEAR(static_cast<double>(told.size()), 0.5 / kReportEvery_s, 2);
}

constexpr double kRadius = 0.02;

BodyDescription ball(Vec3 velocity, Vec3 spin) {
  BodyDescription body = body_of("ball", ShapeType::sphere, {0, 0, kRadius});
  body.shape.radius_m = kRadius;
  body.density_kg_m3 = 7800;
  body.velocity_m_s = velocity;
  body.spin_rad_s = spin;
  return body;
}

World ball_world(Vec3 velocity, Vec3 spin, double rolling_m) {
  SceneDescription scene = scene_of({ball(velocity, spin)}, 0);
  scene.bodies[0].surface.rolling_m = scene.statics[0].surface.rolling_m = rolling_m;
  scene.step_s = 0.001;
  return world_of(scene, {sounding("ball", 0, box_bank(kSize, 1))});
}

TEST(Rolling, RollingIsToldAsRollAndNotAsSlip) {
  World world = ball_world({0.6, 0.8, 0}, {-0.8 / kRadius, 0.6 / kRadius, 0}, 0);
  const auto told = contacts(world, 1);
  ASSERT_GT(told.size(), 200u);
  for (std::size_t k = 2; k < told.size(); ++k) {
    EXPECT_NEAR(told[k].contact.roll_m_s, 1, 0.02) << k;
    EXPECT_LT(told[k].contact.slip_m_s, 0.01) << k;
    EXPECT_NEAR(length(told[k].point_m), kRadius, 0.001) << "somewhere on the ball";
  }
}

TEST(Rolling, AThrownBallSkidsUntilFiveSeventhsOfItsSpeedAreLeft) {
  World world = ball_world({1.4, 0, 0}, {}, 0);
  const auto told = contacts(world, 1);
  ASSERT_GT(told.size(), 100u);
  EXPECT_GT(told[2].contact.slip_m_s, 1);
  EXPECT_NEAR(told.back().contact.roll_m_s, 1, 0.02);
  EXPECT_LT(told.back().contact.slip_m_s, 0.01);
  EXPECT_NEAR(world.bodies()[0].velocity_m_s.x, 1, 0.01);
}

TEST(Rolling, RollingResistanceStopsABallAfterItsDistanceAndItSleeps) {
  // Rolling about the contact point: 7/5 m r^2 a / r = b m g, so that a = 5/7 g b / r.
  const double b = 0.001, speed = 0.5, slowing = 5.0 / 7 * kG * b / kRadius;
  World world = ball_world({speed, 0, 0}, {0, speed / kRadius, 0}, b);
  test::run_all(world, speed / slowing + 1);
  EXPECT_NEAR(world.bodies()[0].position_m.x, speed * speed / (2 * slowing), 0.03 * speed * speed / (2 * slowing));
  EXPECT_EQ(world.bodies()[0].velocity_m_s, (Vec3{})) << "it sleeps";
  EXPECT_EQ(world.bodies()[0].spin_rad_s, (Vec3{}));
  EXPECT_TRUE(test::run_all(world, 1).empty());
}

TEST(Rolling, ABallLiesOnASlopeThatIsNotTooSteepForItAndRollsDownASteeperOne) {
  const double b = 0.002;  // holds it up to a slope of b / r = 0.1
  for (const double slope : {0.05, 0.09, 0.11, 0.2}) {
    BodyDescription body = ball({}, {});
    SceneDescription scene = scene_of({body}, 0);
    scene.bodies[0].surface.rolling_m = scene.statics[0].surface.rolling_m = b;
    const double angle = std::atan(slope);
    scene.gravity_m_s2 = {kG * std::sin(angle), 0, -kG * std::cos(angle)};
    World world = world_of(scene, {sounding("ball", 0, box_bank(kSize, 1))});
    test::run_all(world, 1);
    const double down = std::max(5.0 / 7 * kG * (std::sin(angle) - b / kRadius * std::cos(angle)), 0.0);
    EXPECT_NEAR(world.bodies()[0].position_m.x, 0.5 * down, 0.02 * down + 1e-4) << slope;
    if (down == 0) {
      EXPECT_EQ(world.bodies()[0].velocity_m_s, (Vec3{})) << slope;
    }
  }
}

TEST(Rolling, ASpinningBallComesToRestToo) {
  World world = ball_world({}, {0, 0, 40}, 0.001);
  test::run_all(world, 3);
  EXPECT_EQ(world.bodies()[0].spin_rad_s, (Vec3{}));
}

const Rotation kTurned = about({0, 0, 1}, 1.1);

// A box that slides along x on a fixed tray, which is turned.
SceneDescription box_on_tray() {
  BodyDescription tray = body_of("tray", ShapeType::box, {0, 0, 0});
  tray.shape.size_m = {2, 2, 0.1};
  tray.fixed = true;
  tray.rotation = kTurned;
  BodyDescription box = body_of("box", ShapeType::box, {0, 0, 0.1});
  box.velocity_m_s = {1, 0, 0};
  return scene_of({tray, box}, 0);
}

TEST(Contact, AContactTellsBothObjectsOppositeForces) {
  const SceneDescription scene = box_on_tray();
  World world = world_of(scene, {sounding("tray", 1, box_bank(kSize, 1)), sounding("box", 2, box_bank(kSize, kMass))});
  const auto told = contacts(world, 0.1);
  std::map<synth::Frame, std::map<synth::ObjectNumber, test::Told<synth::verb::Contact>>> by_frame;
  for (const auto& event : told) by_frame[event.frame][event.object] = event;
  ASSERT_GT(by_frame.size(), 5u);
  for (const auto& [frame, both] : by_frame) {
    ASSERT_EQ(both.size(), 2u);
    const Vec3 on_tray = to_matrix(kTurned) * both.at(1).contact.force_n;
    EXPECT_NEAR(length(on_tray + both.at(2).contact.force_n), 0, 1e-6 * length(on_tray));
    EXPECT_EQ(both.at(1).contact.slip_m_s, both.at(2).contact.slip_m_s);
    const Vec3 place = to_matrix(kTurned) * both.at(1).point_m;
    EXPECT_NEAR(place.z, 0.05, 0.002);
  }
}

// As above, but the box is two-way, and lies on a turned tray: one event, which says where both are touched.
TEST(Contact, ATwoWayBodyRubsAndIsRubbedInOneEvent) {
  SceneDescription scene = box_on_tray();
  scene.bodies[1].two_way = true;
  for (BodyDescription& body : scene.bodies) {
    body.surface.friction = 0.2, body.surface.sliding_friction = 0.1;
    body.surface.texture.roughness_m = 3e-6;
    body.surface.edge_radius_m = 0.001, body.surface.young_pa = 6e10, body.surface.poisson = 0.25;
  }
  World world = world_of(scene, {sounding("tray", 1, box_bank(kSize, 1)), sounding("box", 2, box_bank(kSize, kMass))});
  const std::vector<Event> events = test::run_all(world, 3);
  EXPECT_TRUE(test::only<synth::verb::Contact>(events).empty());
  const auto all = test::only<synth::verb::Rub>(events);
  ASSERT_GT(all.size(), 10u);
  for (const auto& rub : std::span(all).subspan(2, all.size() - 3)) {
    const bool of_tray = rub.object == 1;
    const Rotation turned = of_tray ? kTurned : Rotation{};
    EXPECT_EQ(rub.object, all.front().object);
    EXPECT_EQ(rub.object + rub.other, 3u);
    EXPECT_NEAR(rub.load_n, kMass * kG, 0.1 * kMass * kG);
    EXPECT_NEAR(dot(rub.direction, rub.contact.force_n), rub.load_n, 1e-9 * rub.load_n);
    EXPECT_NEAR(rub.direction.z, of_tray ? -1 : 1, 1e-6);
    const Vec3 slide = rotated(turned, rub.slide_m_s);
    EXPECT_NEAR(length(slide), rub.contact.slip_m_s, 1e-6);
    EXPECT_NEAR(of_tray ? slide.x : -slide.x, rub.contact.slip_m_s, 1e-3) << "of the other past it";
    EXPECT_NEAR(rub.mass_kg, kMass, 0.1 * kMass);
    EXPECT_NEAR(rub.friction, 0.2, 1e-12);
    EXPECT_NEAR(rub.sliding, 0.5, 1e-12);
    const double depth = std::pow(rub.load_n / rub.stiffness, 2.0 / 3);
    const double modulus = 6e10 / (2 * (1 - 0.25 * 0.25)), rough = 1.5 * 0.4 * std::sqrt(2.0) * 3e-6;
    EXPECT_NEAR(depth, rough + std::pow(0.75 * rub.load_n / (modulus * std::sqrt(0.001)), 2.0 / 3), 1e-3 * depth);
    const Rotation of_other = of_tray ? Rotation{} : kTurned;
    const Vec3 up = rotated(rub.to_other, rub.direction), x = rotated(rub.to_other, {1, 0, 0});
    EXPECT_NEAR(length(rotated(of_other, up) - rotated(turned, rub.direction)), 0, 1e-6);
    EXPECT_NEAR(length(rotated(of_other, x) - rotated(turned, {1, 0, 0})), 0, 1e-6);
    EXPECT_NEAR(of_tray ? rub.other_point_m.z : rub.point_m.z, -0.05, 2e-3);
    EXPECT_NEAR(of_tray ? rub.point_m.z : rub.other_point_m.z, 0.05, 2e-3);
  }
  EXPECT_EQ(all.back().load_n, 0) << "it comes to rest";
}

TEST(Contact, ContactsOfOneObjectHaveNumbersOfTheirOwnWhichAreUsedAgain) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < 3; ++k) {
    bodies.push_back(body_of("box", ShapeType::box, {0, 0.5 * k, 0.05}));
    bodies.back().name += std::to_string(k);
    bodies.back().velocity_m_s = {1, 0, 0};
    bodies.back().start_s = k == 2 ? 2 : 0;
  }
  SceneDescription scene = scene_of(bodies, 0);
  scene.objects.resize(1);
  World world = world_of(scene, {sounding("box", 7, box_bank(kSize, 1))});
  std::map<std::uint32_t, int> numbers;
  for (const auto& event : contacts(world, 0.1)) ++numbers[event.contact.number];
  EXPECT_EQ(numbers.size(), 2u) << "two slide at once";
  test::run_all(world, 1.8);
  numbers.clear();
  for (const auto& event : contacts(world, 0.4)) ++numbers[event.contact.number];
  EXPECT_EQ(numbers.size(), 1u);
  EXPECT_EQ(numbers.begin()->first, 0u);
}

TEST(Contact, ABounceIsAStrikeAndNothingThatLasts) {
  World world =
      world_of(scene_of({body_of("a", ShapeType::sphere, {0, 0, 1})}, 0.8), {sounding("a", 0, box_bank(kSize, 1))});
  const auto events = test::run_all(world, 1.5);
  EXPECT_GT(test::only<synth::verb::Strike>(events).size(), 1u);
  EXPECT_EQ(test::only<synth::verb::Contact>(events).size(), 0u);
}

TEST(Contact, AStackThatSettlesHasNoContactThatLasts) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 5; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, ShapeType::box, {0.003 * k, 0, 0.05 + 0.102 * k}));
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank({0.1, 0.1, 0.1}, 1)));
  }
  World world = world_of(scene_of(bodies, 0.2), objects);
  test::run_all(world, 1.5);
  EXPECT_TRUE(test::run_all(world, 5).empty());
}

}  // namespace
}  // namespace ringdown::scene::lasting_test
