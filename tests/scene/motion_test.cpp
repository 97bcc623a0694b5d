// Mass and inertia arrive in the physics engine: free motion against mechanics.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::scene::motion_test {
namespace {

using test::body_of;
using test::box_bank;
using test::run;
using test::sounding;
using test::world_of;

// Three different moments; by formula, about the centre of mass: 0.0433, 0.0333, 0.0167 kg m^2.
constexpr Vec3 kSize{0.2, 0.4, 0.6}, kCenter{0.5, 0, -0.3};
constexpr double kMass = 1;
const Vec3 kMoments{kMass / 12 * (0.16 + 0.36), kMass / 12 * (0.04 + 0.36), kMass / 12 * (0.04 + 0.16)};

World spinning(Vec3 spin, Vec3 velocity = {}) {
  BodyDescription body = body_of("a", ShapeType::box, {0, 0, 10});
  body.spin_rad_s = spin;
  body.velocity_m_s = velocity;
  SceneDescription scene = test::scene_of({body});
  scene.gravity_m_s2 = {};
  scene.step_s = 1.0 / 2000;
  return world_of(scene, {sounding("a", 0, box_bank(kSize, kMass, kCenter))});
}

Vec3 angular_momentum(const BodyState& state) {
  const Matrix3 r = to_matrix(state.rotation);
  const Vec3 spin = transpose(r) * state.spin_rad_s;
  return r * Vec3{kMoments.x * spin.x, kMoments.y * spin.y, kMoments.z * spin.z};
}

TEST(Motion, FreeTumblingConservesAngularMomentumAndEnergy) {
  World world = spinning({0.3, 8, 0.2});  // about the middle axis: it turns over (Dzhanibekov)
  const Vec3 before = angular_momentum(world.bodies()[0]);
  const double energy = 0.5 * dot(before, world.bodies()[0].spin_rad_s);
  bool turned_over = false;
  for (int k = 0; k < 20000; ++k) {
    world.step();
    const BodyState state = world.bodies()[0];
    turned_over |= dot(to_matrix(state.rotation) * Vec3{0, 1, 0}, {0, 1, 0}) < -0.5;
  }
  const BodyState after = world.bodies()[0];
  EXPECT_NEAR(length(angular_momentum(after) - before) / length(before), 0, 1e-10);
  EXPECT_NEAR(0.5 * dot(angular_momentum(after), after.spin_rad_s) / energy, 1, 1e-10);
  EXPECT_TRUE(turned_over);
}

TEST(Motion, ThePeriodOfASmallWobbleFollowsFromTheMoments) {
  // Euler's equations about the axis of the smallest moment: the transverse spin turns in the body's frame at
  // w3 sqrt((I1 - I3)(I2 - I3) / (I1 I2)).
  const double w3 = 20;
  World world = spinning({0.2, 0, w3});
  const double rate = w3 * std::sqrt((kMoments.x - kMoments.z) * (kMoments.y - kMoments.z) / (kMoments.x * kMoments.y));
  std::vector<double> crossings;
  double last = 0.2;
  while (crossings.size() < 5) {
    world.step();
    const BodyState state = world.bodies()[0];
    const double now = (transpose(to_matrix(state.rotation)) * state.spin_rad_s).x;
    if (last < 0 && now >= 0) crossings.push_back(world.time_s() + world.step_s() * now / (last - now));
    last = now;
  }
  EXPECT_NEAR((crossings.back() - crossings.front()) / 4, 2 * M_PI / rate, 0.01 * 2 * M_PI / rate);
}

TEST(Motion, TheCentreOfMassFliesStraightAndTheObjectFrameTurnsAboutIt) {
  World world = spinning({0, 0, 3}, {1, 0, 0});
  const Vec3 start = world.bodies()[0].center_m;
  EXPECT_NEAR(length(start - (Vec3{0, 0, 10} + kCenter)), 0, 1e-12);
  run(world, 1);
  const BodyState state = world.bodies()[0];
  EXPECT_NEAR(length(state.center_m - start - Vec3{world.time_s(), 0, 0}), 0, 1e-9);
  const double angle = 3 * world.time_s();
  const Vec3 arm{-(0.5 * std::cos(angle)), -(0.5 * std::sin(angle)), 0.3};
  EXPECT_NEAR(length(state.position_m - state.center_m - arm), 0, 1e-3);
}

TEST(Motion, AFallIsAParabola) {
  World world =
      world_of(test::scene_of({body_of("a", ShapeType::box, {0, 0, 100})}), {sounding("a", 0, box_bank(kSize, kMass))});
  run(world, 2);
  const double t = world.time_s();
  EXPECT_NEAR(world.bodies()[0].position_m.z, 100 - 0.5 * 9.81 * t * t, 1e-9);
}

TEST(Motion, ABoxSlidesToAStopByCoulombsLaw) {
  BodyDescription body = body_of("a", ShapeType::box, {0, 0, 0.3});
  body.velocity_m_s = {1, 0, 0};
  body.surface.friction = 0.3;
  SceneDescription scene = test::scene_of({body}, 0);
  scene.bodies[0].position_m.z = 0.2999;
  scene.statics[0].surface.friction = 0.3;
  scene.step_s = 1.0 / 2000;
  World world = world_of(scene, {sounding("a", 0, box_bank(kSize, kMass))});
  run(world, 2);
  EXPECT_NEAR(world.bodies()[0].position_m.x, 1 / (2 * 0.3 * 9.81), 0.03 / (2 * 0.3 * 9.81));
}

}  // namespace
}  // namespace ringdown::scene::motion_test
