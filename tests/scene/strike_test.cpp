// What a collision sounds like: strength, direction, place and time of the events, against closed forms.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace ringdown::scene::strike_test {
namespace {

using synth::Event;
using test::body_of;
using test::box_bank;
using test::run;
using test::scene_of;
using test::sounding;
using test::Struck;
using test::world_of;

constexpr Vec3 kSize{0.1, 0.1, 0.1};

// One body dropped by `height` onto the floor, at a fine step; the strikes of its first landing.
std::vector<Struck> first_landing(ShapeType shape, double mass_kg, double height, double restitution) {
  const double rest = shape == ShapeType::sphere ? 0.05 * std::sqrt(3.0) : 0.05;
  SceneDescription scene = scene_of({body_of("a", shape, {0, 0, rest + height})}, restitution);
  scene.step_s = 1.0 / 4000;
  World world = world_of(scene, {sounding("a", 5, box_bank(kSize, mass_kg))});
  const double fall = std::sqrt(2 * height / 9.81);
  return run(world, fall + 0.01);
}

struct Drop {
  ShapeType shape;
  double mass_kg, height_m, restitution;
};

void PrintTo(const Drop& drop, std::ostream* out) {
  *out << "shape " << static_cast<int>(drop.shape) << ", " << drop.mass_kg << " kg from " << drop.height_m
       << " m, restitution " << drop.restitution;
}

class DropTest : public testing::TestWithParam<Drop> {};

TEST_P(DropTest, ImpulseIsMassTimesOnePlusRestitutionTimesFallSpeed) {
  const auto [shape, mass, height, e] = GetParam();
  const auto strikes = first_landing(shape, mass, height, e);
  ASSERT_FALSE(strikes.empty());
  for (const Struck& strike : strikes) EXPECT_EQ(strike.object, 5u);
  const double expected = mass * (1 + e) * std::sqrt(2 * 9.81 * height);
  const Vec3 impulse = test::total_impulse(strikes, 5);
  EXPECT_NEAR(impulse.z, expected, 0.02 * expected);
  EXPECT_LT(std::hypot(impulse.x, impulse.y), 0.001 * expected);
  EXPECT_NEAR(static_cast<double>(strikes.front().frame), 48000 * std::sqrt(2 * height / 9.81), 1);
  RecordProperty("error_percent", std::to_string(100 * (impulse.z / expected - 1)));
}

INSTANTIATE_TEST_SUITE_P(Heights, DropTest,
                         testing::Values(Drop{ShapeType::sphere, 1, 0.5, 0.5}, Drop{ShapeType::sphere, 0.01, 0.1, 0.8},
                                         Drop{ShapeType::sphere, 20, 1, 0.3}, Drop{ShapeType::sphere, 1, 0.2, 0},
                                         Drop{ShapeType::sphere, 1, 0.2, 1}, Drop{ShapeType::box, 1, 0.5, 0.5},
                                         Drop{ShapeType::box, 5, 0.05, 0.2}, Drop{ShapeType::convex, 1, 0.5, 0.5},
                                         Drop{ShapeType::trimesh, 1, 0.5, 0.5}));

TEST(Strike, TheImpulseOfALandingIsThatOfTheClosedFormAtEveryStep) {
  for (const double step_s : {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 500, 1.0 / 2000}) {
    for (const double height : {0.02, 0.1, 0.5}) {
      for (const double e : {0.0, 0.3, 0.8}) {
        SceneDescription scene = scene_of({body_of("a", ShapeType::box, {0, 0, 0.05 + height})}, e);
        scene.step_s = step_s;
        World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1))});
        std::vector<Struck> blow;
        while (blow.empty() && world.time_s() < 1) blow = run(world, 0.5 * step_s);
        std::erase_if(blow, [&](const Struck& strike) { return strike.frame > blow.front().frame; });
        const double expected = (1 + e) * std::sqrt(2 * 9.81 * height);
        EXPECT_NEAR(test::total_impulse(blow, 0).z, expected, 0.005 * expected)
            << "step " << step_s << ", from " << height << ", restitution " << e;
      }
    }
  }
}

// Two spheres, the upper one two-way: its fall ends in one event for both, with the mass that both oppose.
TEST(Strike, ATwoWayBodyMeetsTheOtherWithTheirCommonMass) {
  const double height = 0.2, radius = 0.05 * std::sqrt(3.0);
  SceneDescription scene = scene_of({body_of("below", ShapeType::sphere, {0, 0, radius}),
                                     body_of("above", ShapeType::sphere, {0, 0, 3 * radius + height})},
                                    0.5);
  scene.step_s = 1.0 / 4000;
  scene.bodies[1].two_way = true;
  World world = world_of(scene, {sounding("below", 3, box_bank(kSize, 2)), sounding("above", 4, box_bank(kSize, 1))});
  std::vector<test::Told<synth::verb::Collision>> touches;
  while (touches.empty() && world.time_s() < 1) {
    const auto report = world.step();
    touches = test::only<synth::verb::Collision>(report.events);
  }
  ASSERT_FALSE(touches.empty());
  const auto& touch = touches.front();
  EXPECT_EQ(touch.object + touch.other, 7u);
  const double down = touch.object == 3 ? -1 : 1;
  EXPECT_NEAR(touch.direction.z, down, 1e-3);
  EXPECT_NEAR(touch.other_direction.z, -down, 1e-3);
  EXPECT_NEAR(touch.mass_kg, 2.0 / 3, 1e-3);
  EXPECT_NEAR(touch.speed_m_s, std::sqrt(2 * 9.81 * height), 0.02);
  EXPECT_NEAR(touch.point_m.z, (touch.object == 3 ? 1 : -1) * radius, 2e-3);
  const double depth = std::pow(1.25 * touch.mass_kg * touch.speed_m_s * touch.speed_m_s / touch.stiffness, 0.4);
  EXPECT_NEAR(2.943 * depth / touch.speed_m_s, touch.contact_time_s, 0.01 * touch.contact_time_s);
}

// Whole steps of a fall until one has strikes; the change of momentum in it that gravity did not make.
double momentum_given(World& world, std::size_t body, double mass, std::vector<Struck>& strikes) {
  for (;;) {
    const double before = world.bodies()[body].velocity_m_s.z;
    const auto report = world.step();
    if (report.events.empty()) continue;
    strikes = test::only<synth::verb::Strike>(report.events);
    return mass * (world.bodies()[body].velocity_m_s.z - before + 9.81 * world.step_s());
  }
}

TEST(Strike, ImpulseIsTheChangeOfMomentum) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::sphere, ShapeType::convex, ShapeType::trimesh}) {
    for (const double turn : {0.0, 0.6}) {
      BodyDescription body = body_of("a", shape, {0, 0, 0.4});
      body.rotation = about({1, 2, 0}, turn);
      World world = world_of(scene_of({body}), {sounding("a", 0, box_bank(kSize, 3))});
      std::vector<Struck> strikes;
      const double given = momentum_given(world, 0, 3, strikes);
      const double impulse = (to_matrix(body.rotation) * test::total_impulse(strikes, 0)).z;
      EXPECT_NEAR(impulse / given, 1, 0.02) << static_cast<int>(shape) << " turned by " << turn;
    }
  }
}

TEST(Strike, ImpulseIsTheChangeOfMomentumByTheIterativeSolverToo) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 30; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, ShapeType::box, {0.2 * k, 0, 0.3}));
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank(kSize, 1 + k)));
  }
  World world = world_of(scene_of(bodies), objects);
  std::vector<Struck> strikes;
  const double given = momentum_given(world, 17, 18, strikes);
  ASSERT_EQ(strikes.size(), 4u * 30) << "all land at once, on four corners each";
  EXPECT_NEAR(test::total_impulse(strikes, 17).z / given, 1, 0.02);
}

// A box that lands on four corners clicks once, by all it receives.
TEST(Strike, ABlowClicksOnceWithAllItsImpulse) {
  for (const bool clicks : {true, false}) {
    SceneDescription scene = scene_of({body_of("a", ShapeType::box, {0, 0, 0.4})}, 0.5);
    scene.contact.clicks = clicks;
    World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 3))});
    const auto events = test::run_all(world, 0.35);
    const auto heard = test::only<synth::verb::Click>(events);
    const auto strikes = test::only<synth::verb::Strike>(events);
    ASSERT_EQ(strikes.size(), 4u);
    ASSERT_EQ(heard.size(), clicks ? 1u : 0u);
    if (!clicks) continue;
    EXPECT_EQ(heard[0].frame, strikes[0].frame);
    EXPECT_EQ(heard[0].contact_time_s, strikes[0].contact_time_s);
    EXPECT_NEAR(heard[0].impulse_ns.z / test::total_impulse(strikes, 0).z, 1, 1e-9);
  }
}

TEST(Strike, AFixedBodyDoesNotClick) {
  BodyDescription hanging = body_of("b", ShapeType::box, {0, 0, 0.3});
  hanging.fixed = true;
  World world = world_of(scene_of({body_of("a", ShapeType::sphere, {0, 0, 0.6}), hanging}),
                         {sounding("a", 0, box_bank(kSize, 1)), sounding("b", 1, box_bank(kSize, 1))});
  const auto events = test::run_all(world, 0.4);
  const auto strikes = test::only<synth::verb::Strike>(events);
  const auto heard = test::only<synth::verb::Click>(events);
  ASSERT_GT(strikes.size(), 0u);
  EXPECT_EQ(strikes.size(), 2 * heard.size()) << "both ring";
  for (const auto& click : heard) EXPECT_EQ(click.object, 0u);
}

TEST(Strike, ASettledBodyIsSilent) {
  for (const ShapeType shape : {ShapeType::box, ShapeType::sphere, ShapeType::convex, ShapeType::trimesh}) {
    BodyDescription body = body_of("a", shape, {0, 0, 0.3});
    body.rotation = about({1, 2, 3}, 0.4);
    World world = world_of(scene_of({body}), {sounding("a", 0, box_bank(kSize, 1))});
    EXPECT_GT(run(world, 3).size(), 2u) << static_cast<int>(shape);
    EXPECT_EQ(run(world, 5).size(), 0u) << static_cast<int>(shape);
  }
}

TEST(Strike, AStackSettlesInSilence) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 5; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, ShapeType::box, {0.003 * k, 0, 0.05 + 0.102 * k}));
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank(kSize, 1)));
  }
  World world = world_of(scene_of(bodies, 0.2), objects);
  run(world, 2);
  EXPECT_EQ(run(world, 5).size(), 0u);
  EXPECT_NEAR(world.bodies().back().position_m.z, 0.45, 0.005) << "it still stands";
}

// Bounces of a ball from 1.34 cm at restitution 0.9: the nth gap is 2 * 0.9^n * sqrt(2 h / g), all below 0.1 s.
std::size_t strikes_with_repeat(double minimum_repeat_s) {
  SceneDescription scene = scene_of({body_of("a", ShapeType::sphere, {0, 0, 0.1})}, 0.9);
  scene.contact.minimum_repeat_s = minimum_repeat_s;
  World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1))});
  return run(world, 5).size();
}

TEST(Strike, ChatterWithinTheMinimumRepeatTimeIsOneStrike) {
  EXPECT_GT(strikes_with_repeat(0.02), 8u);
  EXPECT_EQ(strikes_with_repeat(0.2), 1u);
}

TEST(Strike, AStrikeLiesAtItsTimeOfTouchNotOnTheStepsGrid) {
  for (const double step_s : {1.0 / 30, 1.0 / 60, 1.0 / 500, 1.0 / 2000}) {
    for (int k = 0; k < 10; ++k) {
      const double height = 0.2 + 0.0371 * k;
      SceneDescription scene = scene_of({body_of("a", ShapeType::box, {0, 0, 0.05 + height})});
      scene.step_s = step_s;
      World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1))});
      const double fall_s = std::sqrt(2 * height / 9.81);
      const auto strikes = run(world, fall_s + 2 * step_s);
      ASSERT_FALSE(strikes.empty());
      EXPECT_NEAR(static_cast<double>(strikes.front().frame) / 48000, fall_s, 0.02 * step_s + 1.0 / 48000)
          << step_s << " from " << height;
    }
  }
}

TEST(Strike, ContactPointsOfOneBlowAllSound) {
  World world = world_of(scene_of({body_of("a", ShapeType::box, {0, 0, 0.3})}), {sounding("a", 0, box_bank(kSize, 1))});
  const auto strikes = run(world, 0.3);
  ASSERT_EQ(strikes.size(), 4u) << "the four corners of a flat landing";
  for (const Struck& strike : strikes) EXPECT_EQ(strike.frame, strikes.front().frame);
}

TEST(Strike, BothBodiesRingWithOppositeImpulses) {
  BodyDescription left = body_of("left", ShapeType::sphere, {-0.5, 0, 1}), right = left;
  left.velocity_m_s = {2, 0, 0};
  left.rotation = about({1, 1, 0}, 2.2);
  right = body_of("right", ShapeType::sphere, {0.5, 0.05, 1});
  right.rotation = about({0, 1, 1}, -1);
  SceneDescription scene = scene_of({left, right});
  scene.gravity_m_s2 = {};
  World world = world_of(scene, {sounding("left", 1, box_bank(kSize, 1)), sounding("right", 2, box_bank(kSize, 3))});
  const auto strikes = run(world, 1);
  ASSERT_EQ(strikes.size(), 2u);
  const Vec3 on_left = to_matrix(left.rotation) * test::total_impulse(strikes, 1);
  const Vec3 on_right = to_matrix(right.rotation) * test::total_impulse(strikes, 2);
  EXPECT_NEAR(length(on_left + on_right), 0, 1e-9);
  EXPECT_GT(length(on_left), 0.5);
  EXPECT_LT(on_left.x, 0);
  // Newton: the impulse is the change of momentum, and momentum is conserved.
  const auto states = world.bodies();
  EXPECT_NEAR(length(1.0 * (states[0].velocity_m_s - left.velocity_m_s) - on_left), 0, 1e-9);
  EXPECT_NEAR(length(3.0 * states[1].velocity_m_s - on_right), 0, 1e-9);
}

TEST(Strike, AStrikesPointLiesOnTheSurfaceWhateverTheBodysTurn) {
  const Vec3 center{0.3, -0.2, 0.1};  // of the box in its object frame
  for (int turn = 0; turn < 24; ++turn) {
    BodyDescription body = body_of("a", ShapeType::box, {0, 0, 1});
    body.rotation = about({1.0 + turn, 2.0 - turn, 0.5}, 0.7 * turn);
    SceneDescription scene = scene_of({body});
    scene.step_s = 1.0 / 4000;
    World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1, center))});
    const auto strikes = run(world, 1);
    ASSERT_FALSE(strikes.empty());
    const Vec3 p = strikes.front().point_m - center;
    EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 0.05, 0.003) << turn;
  }
}

TEST(Strike, TurningSceneAndGravityTogetherChangesNothing) {
  const auto landing = [](const Rotation& turn) {
    BodyDescription body = body_of("a", ShapeType::box, to_matrix(turn) * Vec3{0, 0, 0.4});
    const Rotation tilt = about({1, 0.3, 0}, 0.5);  // turn * tilt, as quaternions
    body.rotation = Rotation::from_xyzw(turn.w * tilt.x + turn.x * tilt.w + turn.y * tilt.z - turn.z * tilt.y,
                                        turn.w * tilt.y - turn.x * tilt.z + turn.y * tilt.w + turn.z * tilt.x,
                                        turn.w * tilt.z + turn.x * tilt.y - turn.y * tilt.x + turn.z * tilt.w,
                                        turn.w * tilt.w - turn.x * tilt.x - turn.y * tilt.y - turn.z * tilt.z);
    SceneDescription scene = scene_of({body});
    scene.gravity_m_s2 = to_matrix(turn) * Vec3{0, 0, -9.81};
    scene.statics[0].normal = to_matrix(turn) * Vec3{0, 0, 1};
    // ODE's friction pyramid has corners that do not turn along, as long as nothing slides.
    scene.statics[0].surface.friction = scene.statics[0].surface.rolling_m = 0;
    World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1))});
    const auto strikes = run(world, 1);
    return strikes.empty() ? Struck{} : strikes.front();
  };
  const Struck flat = landing({}), turned = landing(about({3, -1, 2}, 1.1));
  EXPECT_EQ(flat.frame, turned.frame);
  EXPECT_NEAR(length(flat.point_m - turned.point_m), 0, 1e-9);
  EXPECT_NEAR(length(flat.impulse_ns - turned.impulse_ns), 0, 1e-9);
  EXPECT_GT(length(flat.impulse_ns), 0.1);
}

TEST(Strike, AFixedBodyRingsAndStaysWhereItIs) {
  BodyDescription bell = body_of("bell", ShapeType::convex, {0, 0, 1});
  bell.fixed = true;
  bell.surface.contact_time_s = 0.004;
  BodyDescription ball;
  ball.name = "ball";
  ball.shape = {ShapeType::sphere, {}, 0.02};
  ball.density_kg_m3 = 7800;
  ball.position_m = {0, 0, 1.3};
  World world = world_of(scene_of({bell, ball}), {sounding("bell", 9, box_bank(kSize, 1))});
  const auto strikes = run(world, 2);
  ASSERT_FALSE(strikes.empty());
  EXPECT_LT(strikes.front().impulse_ns.z, 0) << "the ball pushes down";
  EXPECT_EQ(strikes.front().contact_time_s, 0.004) << "the longer of the two";
  EXPECT_EQ(world.bodies()[0].position_m, (Vec3{0, 0, 1}));
}

TEST(Strike, AFixedBodyNeedsNoMass) {
  modal::Bank bank = box_bank(kSize, 1);
  bank.mass.reset();
  BodyDescription bell = body_of("bell", ShapeType::box, {0, 0, 1});
  bell.fixed = true;
  EXPECT_TRUE(World::create(scene_of({bell}), std::vector{sounding("bell", 0, bank)}, 48000));
}

TEST(Strike, FramesOfStrikesNeverFallAndStartWhereTheyAreTold) {
  SceneDescription scene = scene_of({body_of("a", ShapeType::box, {0, 0, 0.3})}, 0.8);
  World world = world_of(scene, {sounding("a", 0, box_bank(kSize, 1))});
  world.set_start_frame(1'000'000);
  synth::Frame last = 1'000'000;
  for (const Event& event : test::run_all(world, 4)) {
    EXPECT_GE(event.frame, last);
    last = event.frame;
  }
  EXPECT_GT(last, 1'000'000);
}

std::vector<Event> crowd(std::uint64_t seed) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 12; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, static_cast<ShapeType>(k % 3), {0.02 * (k % 4), 0.01 * k, 0.2 + 0.15 * k}));
    bodies.back().scatter_m = 0.02;
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank(kSize, 1 + k)));
  }
  SceneDescription scene = scene_of(bodies);
  scene.seed = seed;
  World world = world_of(scene, objects);
  return test::run_all(world, 3);
}

TEST(Strike, TheSameSeedGivesTheSameEventsBitForBit) {
  const auto first = crowd(3), second = crowd(3), other = crowd(4);
  ASSERT_GT(first.size(), 50u);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_TRUE(test::same_bits(first[k], second[k])) << k;
  EXPECT_FALSE(other.size() == first.size() && test::same_bits(other.front(), first.front()));
}

}  // namespace
}  // namespace ringdown::scene::strike_test
