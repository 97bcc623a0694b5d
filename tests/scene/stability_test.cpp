// Scenes that break weak simulators: towers, piles, unequal masses, thin plates, bullets, long and short steps.
//
// RINGDOWN_STRESS=long runs them for longer and with more bodies.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace ringdown::scene::stability_test {
namespace {

using test::body_of;
using test::box_bank;
using test::sounding;
using test::world_of;

bool is_long() {
  const char* form = std::getenv("RINGDOWN_STRESS");
  return form && std::string(form) == "long";
}

constexpr double kSteps[] = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 500, 1.0 / 2000};

BodyDescription box(const std::string& name, Vec3 size, Vec3 position, double density = 1000) {
  BodyDescription body;
  body.name = name;
  body.shape = {ShapeType::box, size, 0};
  body.density_kg_m3 = density;
  body.position_m = position;
  return body;
}

BodyDescription ball(const std::string& name, double radius, Vec3 position, double density = 1000) {
  BodyDescription body = box(name, {}, position, density);
  body.shape = {ShapeType::sphere, {}, radius};
  return body;
}

// All of them fly as fast as that, somewhere.
double fastest(const World& world) {
  double speed = 0;
  for (const BodyState& body : world.bodies()) speed = std::max(speed, length(body.velocity_m_s));
  return speed;
}

void settle(World& world, double seconds) {
  while (world.time_s() < seconds) {
    const auto report = world.step();
    ASSERT_TRUE(report.notices.empty()) << report.notices.front();
    ASSERT_EQ(report.dropped_contacts, 0u);
  }
}

// Twenty boxes, `pitch` apart, stand for a minute. Faces that touch exactly have nothing in each other.
void stand(double step_s, double pitch, double restitution) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < 20; ++k) {
    bodies.push_back(box("b" + std::to_string(k), {0.1, 0.1, 0.1}, {0.002 * (k % 3), 0, pitch * (k + 0.5)}));
  }
  SceneDescription scene = test::scene_of(bodies, restitution);
  scene.step_s = step_s;
  World world = world_of(scene, {});
  settle(world, 5);
  EXPECT_EQ(fastest(world), 0) << "it sleeps";
  settle(world, 60);
  const auto states = world.bodies();
  for (int k = 0; k < 20; ++k) {
    EXPECT_NEAR(states[k].position_m.z, 0.05 + 0.1 * k, 0.005) << k;
    EXPECT_LT(std::hypot(states[k].position_m.x - 0.002 * (k % 3), states[k].position_m.y), 0.02) << k;
  }
}

TEST(Stability, ATowerOfTwentyBoxesStandsForAMinuteAndSleeps) {
  for (const double step_s : kSteps) {
    for (const double pitch : {0.1, 0.0999}) {
      SCOPED_TRACE("step " + std::to_string(step_s) + ", pitch " + std::to_string(pitch));
      stand(step_s, pitch, 0.2);
    }
  }
  stand(1.0 / 30, 0.1, 0.6);
}

TEST(Stability, APileOfTwoHundredBodiesSettles) {
  const int count = is_long() ? 1000 : 200;
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < count; ++k) {
    const Vec3 place{0.09 * (k % 5) - 0.18, 0.09 * (k / 5 % 5) - 0.18, 0.1 + 0.09 * (k / 25)};
    bodies.push_back(k % 2 ? box("b" + std::to_string(k), {0.08, 0.06, 0.05}, place)
                           : ball("b" + std::to_string(k), 0.035, place));
    bodies.back().scatter_m = 0.01;
    bodies.back().surface.rolling_m = 0.002;
  }
  SceneDescription scene = test::scene_of(bodies, 0.3);
  scene.statics[0].surface.rolling_m = 0.002;
  scene.step_s = 1.0 / 250;
  World world = world_of(scene, {});
  settle(world, is_long() ? 40 : 12);
  int moving = 0;
  for (const BodyState& body : world.bodies()) {
    moving += length(body.velocity_m_s) > 0.05;
    EXPECT_GT(body.position_m.z, 0.01) << body.name << " is not in the floor";
  }
  EXPECT_EQ(moving, 0);
}

TEST(Stability, AThousandfoldMassLiesOnALightBodyWithoutCrushingIt) {
  World world = world_of(
      test::scene_of(
          {box("light", {0.1, 0.1, 0.1}, {0, 0, 0.05}, 10), box("heavy", {0.1, 0.1, 0.1}, {0, 0, 0.15}, 10000)}, 0.2),
      {});
  settle(world, 10);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 0.05, 0.003);
  EXPECT_NEAR(world.bodies()[1].position_m.z, 0.15, 0.006);
}

TEST(Stability, AThousandfoldMassStruckByALightOneHardlyMoves) {
  BodyDescription light = ball("light", 0.01, {-0.2, 0, 1}, 1000), heavy = ball("heavy", 0.1, {0, 0, 1}, 1000);
  light.velocity_m_s = {5, 0, 0};
  SceneDescription scene = test::scene_of({light, heavy}, 1);
  scene.gravity_m_s2 = {};
  World world = world_of(scene, {});
  settle(world, 0.2);
  // Elastic: v_light = (m - M)/(m + M) v, v_heavy = 2 m/(m + M) v, with M = 1000 m.
  EXPECT_NEAR(world.bodies()[0].velocity_m_s.x, -999.0 / 1001 * 5, 0.01);
  EXPECT_NEAR(world.bodies()[1].velocity_m_s.x, 2.0 / 1001 * 5, 0.0002);
}

TEST(Stability, ThinPlatesFallAndLieFlat) {
  for (const double step_s : kSteps) {
    std::vector<BodyDescription> bodies;
    for (int k = 0; k < 4; ++k) {
      bodies.push_back(box("p" + std::to_string(k), {0.2, 0.15, 0.001}, {0.5 * k, 0, 0.3}, 7800));
      bodies.back().rotation = about({1, 0.5 * k, 0}, 0.2 + 0.3 * k);
    }
    SceneDescription scene = test::scene_of(bodies, 0.2);
    scene.step_s = step_s;
    World world = world_of(scene, {});
    settle(world, 5);
    for (const BodyState& plate : world.bodies()) {
      EXPECT_NEAR(plate.position_m.z, 0.0005, 0.002) << plate.name << " at step " << step_s;
      EXPECT_NEAR(std::abs((to_matrix(plate.rotation) * Vec3{0, 0, 1}).z), 1, 0.01)
          << plate.name << " at step " << step_s;
    }
  }
}

// A small ball is shot at a thin plate in its way; where is it a little later?
double shoot(double speed, double step_s, bool fixed, double offset) {
  BodyDescription bullet = ball("bullet", 0.003, {-1 + offset, 0, 1}, 7800);
  bullet.velocity_m_s = {speed, 0, 0};
  BodyDescription plate = box("plate", {0.002, 0.5, 0.5}, {0, 0, 1}, 7800);
  plate.fixed = fixed;
  SceneDescription scene = test::scene_of({bullet, plate}, 0.5);
  scene.gravity_m_s2 = {};
  scene.step_s = step_s;
  World world = world_of(scene, {});
  while (world.time_s() < 2 / speed + 3 * step_s) world.step();
  return world.bodies()[0].position_m.x - world.bodies()[1].position_m.x;
}

TEST(Stability, FastBodiesDoNotFlyThroughPlates) {
  for (const double step_s : kSteps) {
    for (const double speed : {5.0, 50.0, 300.0, 900.0}) {
      for (const double offset : {0.0, 0.0017, 0.31}) {
        for (const bool fixed : {true, false}) {
          EXPECT_LT(shoot(speed, step_s, fixed, offset), 0)
              << speed << " m/s, step " << step_s << ", from " << offset << (fixed ? ", fixed" : ", free");
        }
      }
    }
  }
}

// A ball flies past the rim of a thin disc-like plate, or a fixed ball: how much of its width meets it?
bool meets(double overlap, double speed, double step_s, bool plate, double turn) {
  constexpr double kRadius = 0.004;
  BodyDescription bullet = ball("bullet", kRadius, {-1.0013, 0, 1}, 7800);
  bullet.velocity_m_s = {speed, 0, 0};
  const double half = 0.05, far = half + (1 - 2 * overlap) * kRadius;  // from the target's middle to the bullet's
  const Vec3 middle{0, far * std::cos(turn), 1 + far * std::sin(turn)};
  BodyDescription target =
      plate ? box("target", {0.002, 2 * half, 2 * half}, middle, 7800) : ball("target", half, middle);
  target.rotation = about({1, 0, 0}, turn);
  target.fixed = true;
  SceneDescription scene = test::scene_of({bullet, target}, 0.5);
  scene.gravity_m_s2 = {};
  scene.step_s = step_s;
  World world = world_of(scene, {});
  while (world.time_s() < 2 / speed + 3 * step_s) world.step();
  const Vec3 after = world.bodies()[0].velocity_m_s;
  return after.x < 0.999 * speed;
}

TEST(Stability, FastBodiesMeetObstaclesOffTheirMiddle) {
  for (const double step_s : kSteps) {
    for (const double speed : {20.0, 100.0, 400.0}) {
      for (const bool plate : {true, false}) {
        for (const double overlap : {0.1, 0.3, 0.45}) {
          for (const double turn : {0.0, 0.3, 1.1, 2.5, 4.0}) {
            EXPECT_TRUE(meets(overlap, speed, step_s, plate, turn))
                << overlap << " of its width, " << speed << " m/s, step " << step_s << ", turned by " << turn
                << (plate ? ", plate" : ", ball");
          }
        }
        EXPECT_FALSE(meets(-0.05, speed, step_s, plate, 0.3)) << "a miss is a miss";
      }
    }
  }
}

TEST(Stability, TheStrikeOfAFastBodyHasItsImpulseAndTimeAtEveryStep) {
  for (const double step_s : kSteps) {
    BodyDescription bullet = ball("bullet", 0.003, {-1, 0, 1}, 7800);
    bullet.velocity_m_s = {100, 0, 0};
    BodyDescription plate = body_of("plate", ShapeType::box, {0, 0, 1});
    plate.fixed = true;
    SceneDescription scene = test::scene_of({bullet, plate}, 0.5);
    scene.gravity_m_s2 = {};
    scene.step_s = step_s;
    World world = world_of(scene, {sounding("plate", 0, box_bank({0.002, 0.5, 0.5}, 1))});
    const auto strikes = test::run(world, 0.02 + 3 * step_s);
    ASSERT_EQ(strikes.size(), 1u) << step_s;
    const double mass = 7800 * 4.0 / 3 * M_PI * std::pow(0.003, 3);
    EXPECT_NEAR(strikes[0].impulse_ns.x, mass * 1.5 * 100, 0.02 * mass * 1.5 * 100) << step_s;
    EXPECT_NEAR(static_cast<double>(strikes[0].frame) / 48000, (1 - 0.001 - 0.003) / 100, 1.5 / 48000) << step_s;
  }
}

TEST(Stability, BallsBounceAndRestAtEveryStep) {
  for (const double step_s : kSteps) {
    SceneDescription scene = test::scene_of({ball("b", 0.02, {0, 0, 0.5})}, 0.5);
    scene.step_s = step_s;
    World world = world_of(scene, {});
    double highest = 0;
    bool landed = false;
    while (world.time_s() < 8) {
      world.step();
      const double z = world.bodies()[0].position_m.z;
      landed |= world.bodies()[0].velocity_m_s.z > 0;
      if (landed) highest = std::max(highest, z - 0.02);
    }
    const double expected = 0.25 * 0.48;  // e^2 of the height
    EXPECT_NEAR(highest, expected, 0.02 * expected) << step_s;
    EXPECT_NEAR(world.bodies()[0].position_m.z, 0.02, 0.001) << step_s;
    EXPECT_EQ(fastest(world), 0) << step_s;
  }
}

double kinetic_energy(const World& world, double mass, double radius) {
  double energy = 0;
  for (const BodyState& body : world.bodies()) {
    if (body.fixed) continue;
    energy += 0.5 * mass * dot(body.velocity_m_s, body.velocity_m_s) +
              0.2 * mass * radius * radius * dot(body.spin_rad_s, body.spin_rad_s);
  }
  return energy;
}

TEST(Stability, EnergyNeverGrowsInAClosedSceneWithoutForces) {
  for (const double restitution : {1.0, 0.6}) {
    const double radius = 0.05, mass = 1000 * 4.0 / 3 * M_PI * std::pow(radius, 3);
    std::vector<BodyDescription> bodies;
    for (int k = 0; k < 12; ++k) {
      bodies.push_back(
          ball("b" + std::to_string(k), radius, {0.25 * (k % 3) - 0.25, 0.25 * (k / 3 % 2), 0.25 * (k / 6)}));
      bodies.back().velocity_m_s = {std::cos(2.0 * k), std::sin(2.0 * k), std::cos(5.0 * k)};
      bodies.back().spin_rad_s = {5.0 * std::sin(3.0 * k), 0, 7.0};
    }
    SceneDescription scene = test::scene_of(bodies, restitution);
    scene.gravity_m_s2 = {};
    scene.statics.clear();
    for (int side = 0; side < 6; ++side) {
      StaticDescription wall;
      wall.name = "w" + std::to_string(side);
      const double sign = side % 2 ? 1 : -1;
      wall.normal = {side / 2 == 0 ? sign : 0, side / 2 == 1 ? sign : 0, side / 2 == 2 ? sign : 0};
      wall.offset_m = -0.6;
      wall.surface.restitution = restitution;
      scene.statics.push_back(wall);
    }
    World world = world_of(scene, {});
    const double start = kinetic_energy(world, mass, radius);
    double last = start;
    while (world.time_s() < (is_long() ? 300 : 10)) {
      world.step();
      const double now = kinetic_energy(world, mass, radius);
      ASSERT_LE(now, last + 1e-6 * start) << "at " << world.time_s() << " s, restitution " << restitution;
      last = now;
    }
    EXPECT_LT(last, restitution == 1 ? start : 0.5 * start);
  }
}

// Blocks of 1 kg as boxes, hulls and meshes.
constexpr Vec3 kBlock{0.16, 0.1, 0.05}, kBlockMoments{0.0125 / 12, 0.0281 / 12, 0.0356 / 12};

double kinetic_energy_of_blocks(const World& world) {
  double energy = 0;
  for (const BodyState& block : world.bodies()) {
    const Vec3 w = transpose(to_matrix(block.rotation)) * block.spin_rad_s;
    energy += 0.5 * (dot(block.velocity_m_s, block.velocity_m_s) + kBlockMoments.x * w.x * w.x +
                     kBlockMoments.y * w.y * w.y + kBlockMoments.z * w.z * w.z);
  }
  return energy;
}

SceneDescription flying_blocks(ShapeType one, ShapeType other, double restitution, double friction) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < 12; ++k) {
    const Vec3 place{0.25 * (k % 3) - 0.25, 0.25 * (k / 3 % 2), 0.25 * (k / 6)};
    bodies.push_back(body_of("b" + std::to_string(k), k % 2 ? one : other, place));
    bodies.back().velocity_m_s = {2 * std::cos(2.0 * k), 2 * std::sin(2.0 * k), 2 * std::cos(5.0 * k)};
    bodies.back().spin_rad_s = {5 * std::sin(3.0 * k), 0, 7};
    bodies.back().surface.friction = friction;
  }
  SceneDescription scene = test::scene_of(bodies, restitution);
  scene.gravity_m_s2 = {};
  StaticDescription wall = scene.statics.front();
  wall.surface.friction = friction;
  wall.offset_m = -0.6;
  scene.statics.clear();
  for (const Vec3 normal : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    wall.name = "wall" + std::to_string(scene.statics.size());
    wall.normal = normal;
    scene.statics.push_back(wall);
  }
  return scene;
}

std::vector<SoundingObject> blocks(int count) {
  std::vector<SoundingObject> objects;
  for (int k = 0; k < count; ++k) {
    objects.push_back(sounding("b" + std::to_string(k), static_cast<std::uint32_t>(k), box_bank(kBlock, 1)));
  }
  return objects;
}

TEST(Stability, EnergyNeverGrowsAmongBodiesOfEveryShape) {
  for (const ShapeType one : {ShapeType::box, ShapeType::convex, ShapeType::trimesh}) {
    for (const ShapeType other : {ShapeType::convex, ShapeType::trimesh}) {
      for (const double friction : {0.0, 0.5}) {
        World world = world_of(flying_blocks(one, other, 1, friction), blocks(12));
        double last = kinetic_energy_of_blocks(world);
        while (world.time_s() < (is_long() ? 60 : 5)) {
          world.step();
          const double now = kinetic_energy_of_blocks(world);
          ASSERT_LE(now, (1 + 1e-8) * last) << "at " << world.time_s() << " s, shapes " << static_cast<int>(one)
                                            << " and " << static_cast<int>(other) << ", friction " << friction;
          last = now;
        }
      }
    }
  }
}

// 64 blocks that touch, or nearly, and fly apart: islands of more contact points than are solved exactly.
TEST(Stability, EnergyNeverGrowsInACrowd) {
  for (const double pitch : {1.0, 1.05}) {
    std::vector<BodyDescription> bodies;
    for (int k = 0; k < 64; ++k) {
      const Vec3 place{pitch * kBlock.x * (k % 4), pitch * kBlock.y * (k / 4 % 4), pitch * kBlock.z * (k / 16)};
      bodies.push_back(box("b" + std::to_string(k), kBlock, place, 1 / (kBlock.x * kBlock.y * kBlock.z)));
      bodies.back().velocity_m_s = {2 * std::cos(2.0 * k), 2 * std::sin(2.0 * k), 2 * std::cos(5.0 * k)};
      bodies.back().surface.friction = 0;
    }
    SceneDescription scene = test::scene_of(bodies, 1);
    scene.gravity_m_s2 = {};
    scene.statics.clear();
    World world = world_of(scene, {});
    double last = kinetic_energy_of_blocks(world);
    while (world.time_s() < 0.2) {
      world.step();
      const double now = kinetic_energy_of_blocks(world);
      ASSERT_LE(now, (1 + 1e-8) * last) << "at " << world.time_s() << " s, pitch " << pitch;
      last = now;
    }
  }
}

TEST(Stability, StacksOfHullsAndOfMeshesStandInSilence) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::convex, ShapeType::trimesh}) {
    SCOPED_TRACE(static_cast<int>(shape));
    std::vector<BodyDescription> bodies;
    for (int k = 0; k < 6; ++k) {
      bodies.push_back(body_of("b" + std::to_string(k), shape, {0.003 * (k % 3), 0.002 * (k % 2), 0.026 + 0.055 * k}));
    }
    World world = world_of(test::scene_of(bodies, 0.4), blocks(6));
    settle(world, 4);
    EXPECT_EQ(fastest(world), 0) << "it sleeps";
    EXPECT_TRUE(test::run_all(world, 3).empty());
    EXPECT_NEAR(world.bodies().back().position_m.z, 0.025 + 5 * 0.05, 0.002) << "it stands";
  }
}

// In a step from v and z to v - g h and z + h (v - g h), m v^2 / 2 + m g (z - h v / 2) does not change.
TEST(Stability, AFallNeverGainsEnergy) {
  BodyDescription body = box("b", {0.1, 0.06, 0.03}, {0, 0, 0.5});
  body.rotation = about({1, 2, 3}, 0.9);
  SceneDescription scene = test::scene_of({body}, 1);
  World world = world_of(scene, {});
  const double g = 9.81, mass = 0.18;
  const Vec3 moments{mass / 12 * (0.0036 + 0.0009), mass / 12 * (0.01 + 0.0009), mass / 12 * (0.01 + 0.0036)};
  const double start = mass * g * 0.5;
  double last = start;
  while (world.time_s() < 20) {
    world.step();
    const BodyState state = world.bodies()[0];
    const Vec3 spin = transpose(to_matrix(state.rotation)) * state.spin_rad_s;
    const double energy =
        mass * g * (state.center_m.z - 0.5 * scene.step_s * state.velocity_m_s.z) +
        0.5 * mass * dot(state.velocity_m_s, state.velocity_m_s) +
        0.5 * (moments.x * spin.x * spin.x + moments.y * spin.y * spin.y + moments.z * spin.z * spin.z);
    ASSERT_LT(energy, last + 1e-5 * start) << world.time_s();
    last = energy;
  }
}

TEST(Stability, TenThousandBouncesWithoutLossGainNothing) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::convex}) {
    World world = world_of(flying_blocks(shape, shape, 1, 0), blocks(12));
    const double start = kinetic_energy_of_blocks(world);
    double last = start;
    for (std::ptrdiff_t bounces = 0; bounces < 10000;) {
      const auto report = world.step();
      bounces += test::only<synth::verb::Strike>(report.events).size();
      const double now = kinetic_energy_of_blocks(world);
      ASSERT_LE(now, last * (1 + 1e-8)) << "at " << world.time_s() << " s";
      last = now;
    }
    EXPECT_LE(last, start);
    EXPECT_GT(last, 0.8 * start) << "nor do they lose much";
  }
}

TEST(Stability, AScenePushedBeyondReasonNeitherEndsTheProgramNorPoisonsOthers) {
  std::vector<BodyDescription> bodies{box("victim", {0.1, 0.1, 0.1}, {0, 50, 0.05}),
                                      box("other", {0.1, 0.1, 0.1}, {0.3, 0, 0.05})};
  World world = world_of(test::scene_of(bodies), {});
  std::size_t notices = 0;
  for (int k = 0; k < 400; ++k) {
    if (k % 20 == 0 && !world.bodies().empty() && world.bodies()[0].name == "victim") {
      ASSERT_TRUE(world.push(world.bodies()[0].id, {k % 40 ? 1e6 : 1.0, 1e5, k % 60 ? -1e6 : 1e6}));
    }
    notices += world.step().notices.size();
    for (const BodyState& body : world.bodies())
      ASSERT_TRUE(is_finite(body.position_m) && is_finite(body.velocity_m_s));
  }
  EXPECT_EQ(notices, static_cast<std::size_t>(kMaxResets) + 1);
  ASSERT_EQ(world.bodies().size(), 1u);
  EXPECT_EQ(world.bodies()[0].name, "other");
}

TEST(Stability, SleepingBodiesGiveNoEventsAndWakeWhenTouched) {
  std::vector<BodyDescription> bodies;
  for (int k = 0; k < 10; ++k) bodies.push_back(box("b" + std::to_string(k), {0.1, 0.1, 0.1}, {0.2 * k, 0, 0.05}));
  World world = world_of(test::scene_of(bodies, 0.2), {});
  settle(world, 2);
  ASSERT_EQ(fastest(world), 0);
  ASSERT_TRUE(world.push(0, {1, 0, 0}));
  settle(world, 2.3);
  EXPECT_GT(world.bodies()[1].position_m.x, 0.2001) << "the first pushes the second";
  EXPECT_EQ(world.bodies()[9].velocity_m_s, (Vec3{}));
}

}  // namespace
}  // namespace ringdown::scene::stability_test
