// Pieces of a scene's bodies that break again.
#include "engine/scene/world.h"
#include "tests/scene/breaking_plate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace ringdown::scene {
namespace {

using test::nested_plate;
using test::only;
using test::plate_objects;
using test::PlateGrid;
using test::world_of;

const double kBallMass_kg = 2000 * 4.0 / 3 * std::numbers::pi * std::pow(0.03, 3);

// The plate without gravity and floor, and two silent balls: the first hits the plate, the second one of its halves.
SceneDescription twice_struck(const Breaks& breaks) {
  BodyDescription plate = test::body_of("plate", ShapeType::convex, {});
  plate.breaks = breaks;
  BodyDescription ball;
  ball.name = "ball";
  ball.shape = {ShapeType::sphere, {}, 0.03};
  ball.density_kg_m3 = 2000;
  ball.position_m = {-0.07, 0.03, 0.05};
  ball.velocity_m_s = {0, 0, -3};
  BodyDescription second = ball;
  second.name = "second";
  second.position_m = {-0.1, -0.03, 0.45};
  second.velocity_m_s = {0, 0, -8};
  SceneDescription scene = test::scene_of({plate, ball, second});
  scene.gravity_m_s2 = {};
  scene.statics.clear();
  scene.bodies[0].velocity_m_s = {0.1, -0.05, 0.2};
  return scene;
}

struct Momentum {
  Vec3 linear, angular;
};

// Masses and moments of inertia are those of boxes and balls by formula.
Momentum momentum_of(const World& world, const PlateGrid& grid) {
  Momentum sum;
  for (const BodyState& body : world.bodies()) {
    const bool is_ball = body.name.find("plate") == std::string::npos;
    const bool is_half = body.name == "plate.0" || body.name == "plate.1";
    const auto along = static_cast<double>(body.name == "plate" ? 1 : is_half ? 2 : grid.along);
    const auto across = static_cast<double>(body.name == "plate" || is_half ? 1 : grid.across);
    const Vec3 size{grid.size_m.x / along, grid.size_m.y / across, grid.size_m.z};
    const double mass = is_ball ? kBallMass_kg : grid.mass_kg / (along * across);
    const double ball = 0.4 * mass * 0.03 * 0.03, k = mass / 12;
    const Vec3 moments = is_ball
                             ? Vec3{ball, ball, ball}
                             : Vec3{k * (size.y * size.y + size.z * size.z), k * (size.x * size.x + size.z * size.z),
                                    k * (size.x * size.x + size.y * size.y)};
    const Vec3 spin = rotated(inverse(body.rotation), body.spin_rad_s);
    const Vec3 own = rotated(body.rotation, Vec3{moments.x * spin.x, moments.y * spin.y, moments.z * spin.z});
    sum.linear = sum.linear + mass * body.velocity_m_s;
    sum.angular = sum.angular + own + mass * cross(body.center_m, body.velocity_m_s);
  }
  return sum;
}

TEST(SecondBreak, AHalfBreaksIntoItsPiecesAndKeepsItsMomentum) {
  const PlateGrid grid;
  World world = world_of(twice_struck({.impulse_ns = 1e-3, .min_mass_kg = 0}), plate_objects(nested_plate(grid)));
  Momentum before = momentum_of(world, grid);
  std::vector<std::string> notices;
  std::vector<synth::Event> events;
  while (notices.size() < 2) {
    ASSERT_LT(world.time_s(), 0.2);
    before = momentum_of(world, grid);
    const StepReport report = world.step();
    notices.insert(notices.end(), report.notices.begin(), report.notices.end());
    events.assign(report.events.begin(), report.events.end());
  }
  EXPECT_EQ(notices[0], "body 'plate' broke into 2 pieces");
  EXPECT_EQ(notices[1], "body 'plate.0' broke into 6 pieces");
  std::set<std::string> names;
  for (const BodyState& body : world.bodies()) names.insert(body.name);
  EXPECT_EQ(names, (std::set<std::string>{"ball", "plate.1", "plate.10", "plate.11", "plate.2", "plate.3", "plate.6",
                                          "plate.7", "second"}))
      << "the left half of the grid";
  const Momentum after = momentum_of(world, grid);
  EXPECT_LT(length(after.linear - before.linear), 1e-10 * length(before.linear));
  EXPECT_LT(length(after.angular - before.angular), 1e-10 * length(before.angular));
  // The half falls silent, and each of its pieces rings.
  const auto chokes = only<synth::verb::Choke>(events);
  ASSERT_EQ(chokes.size(), 1u);
  EXPECT_EQ(chokes[0].object, 1u);
  EXPECT_EQ(only<synth::verb::Impart>(events).size(), 6u);
}

TEST(SecondBreak, PiecesOfOneBodyDoNotCollideUntilTheyWereApart) {
  PlateGrid grid;
  grid.hull = 1.2;  // the hulls overlap
  World world = world_of(twice_struck({.impulse_ns = 1e-3, .min_mass_kg = 0}), plate_objects(nested_plate(grid)));
  std::size_t broken = 0;
  while (broken < 2) {
    ASSERT_LT(world.time_s(), 0.2);
    broken += world.step().notices.size();
  }
  // Neither the pieces of the half nor these and the other half push each other.
  const Momentum before = momentum_of(world, grid);
  const std::vector<BodyState> then = world.bodies();
  world.step();
  const std::vector<BodyState> now = world.bodies();
  ASSERT_EQ(then.size(), now.size());
  for (std::size_t i = 0; i < then.size(); ++i) {
    if (then[i].name.starts_with("plate")) {
      EXPECT_EQ(then[i].velocity_m_s, now[i].velocity_m_s) << then[i].name;
    }
  }
  EXPECT_LT(length(momentum_of(world, grid).linear - before.linear), 1e-12);
}

TEST(SecondBreak, TheStrengthOfAPieceDecides) {
  modal::Bank plate = nested_plate();
  modal::Fracture fracture = *plate.fracture;
  const auto stress = static_cast<float>(1e8 * 2 * std::numbers::pi * 4000);
  fracture.stress = {.positions = {{0.15F, -0.1F, 0}}, .stress = {stress, 0, 0}, .largest = {stress}};
  for (modal::PieceBank& half : fracture.patterns[0].pieces) {
    const Vec3 centre = half.bank.mass->center_of_mass_m;
    half.stress = {
        .positions = {{static_cast<float>(centre.x + 0.07), -0.1F, 0}}, .stress = {stress, 0, 0}, .largest = {stress}};
    half.skin_m2 = 0.06;
  }
  plate.fracture = std::make_shared<const modal::Fracture>(fracture);
  const auto breaks = [&](double strength_pa) {
    World world = world_of(twice_struck({.strength_pa = strength_pa}), plate_objects(plate));
    std::size_t count = 0;
    while (world.time_s() < 0.15) count += world.step().notices.size();
    return count;
  };
  EXPECT_EQ(breaks(1e4), 2u);
  EXPECT_EQ(breaks(1e12), 0u);
}

TEST(SecondBreak, ASecondBreakRepeatsBitForBit) {
  std::vector<synth::Event> first;
  for (int run = 0; run < 2; ++run) {
    World world = world_of(twice_struck({.impulse_ns = 1e-3, .min_mass_kg = 0}), plate_objects(nested_plate()));
    const std::vector<synth::Event> events = test::run_all(world, 0.2);
    if (run == 0) first = events;
    EXPECT_TRUE(std::ranges::equal(events, first, test::same_bits));
  }
}

}  // namespace
}  // namespace ringdown::scene
