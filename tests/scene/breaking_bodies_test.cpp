// Bodies of a scene that break: when, with which momentum, and with which events.
#include "engine/scene/check.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"
#include "engine/scene/world.h"
#include "tests/scene/breaking_plate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::scene {
namespace {

using test::breaking_plate;
using test::only;
using test::plate_objects;
using test::PlateGrid;
using test::world_of;

constexpr double kBallRadius_m = 0.03, kBallDensity = 2000;
const double kBallMass_kg = kBallDensity * 4 / 3 * std::numbers::pi * std::pow(kBallRadius_m, 3);

BodyDescription plate_body(const Breaks& breaks) {
  BodyDescription plate = test::body_of("plate", ShapeType::convex, {});
  plate.breaks = breaks;
  return plate;
}

// A silent ball above the plate, on its way down.
BodyDescription ball_body(Vec3 place_m = {0.07, 0.03, 0.05}, double speed_m_s = 3) {
  BodyDescription ball;
  ball.name = "ball";
  ball.shape = {ShapeType::sphere, {}, kBallRadius_m};
  ball.density_kg_m3 = kBallDensity;
  ball.position_m = place_m;
  ball.velocity_m_s = {0.2, 0, -speed_m_s};
  return ball;
}

// The plate and the ball without gravity and floor.
SceneDescription in_space(const Breaks& breaks, const BodyDescription& ball = ball_body()) {
  SceneDescription scene = test::scene_of({plate_body(breaks), ball});
  scene.gravity_m_s2 = {};
  scene.statics.clear();
  scene.bodies[0].velocity_m_s = {0.1, -0.05, 0.2};
  scene.bodies[0].spin_rad_s = {0.4, 1, -2};
  return scene;
}

// A plate that falls flat, or nearly so, onto the floor.
SceneDescription falling(const Breaks& breaks, double height_m) {
  SceneDescription scene = test::scene_of({plate_body(breaks)});
  scene.bodies[0].position_m.z = height_m;
  scene.bodies[0].rotation = about({1, 0.3, 0}, 0.5);
  return scene;
}

struct Momentum {
  Vec3 linear, angular;
  double kinetic_j = 0;
};

// Returns the momentum of all bodies and their angular momentum about the origin. Moments of inertia are those of boxes
// and balls by formula.
Momentum momentum_of(const World& world, const PlateGrid& grid) {
  Momentum sum;
  const double pieces = static_cast<double>(grid.along * grid.across);
  for (const BodyState& body : world.bodies()) {
    double mass = kBallMass_kg, k = 0.4 * mass * kBallRadius_m * kBallRadius_m;
    Vec3 moments{k, k, k};
    if (body.name != "ball") {
      const bool whole = body.name == "plate";
      const Vec3 size = whole ? grid.size_m
                              : Vec3{grid.size_m.x / static_cast<double>(grid.along),
                                     grid.size_m.y / static_cast<double>(grid.across), grid.size_m.z};
      mass = whole ? grid.mass_kg : grid.mass_kg / pieces;
      k = mass / 12;
      moments = {k * (size.y * size.y + size.z * size.z), k * (size.x * size.x + size.z * size.z),
                 k * (size.x * size.x + size.y * size.y)};
    }
    const Vec3 spin = rotated(inverse(body.rotation), body.spin_rad_s);
    const Vec3 own = rotated(body.rotation, Vec3{moments.x * spin.x, moments.y * spin.y, moments.z * spin.z});
    sum.linear = sum.linear + mass * body.velocity_m_s;
    sum.angular = sum.angular + own + mass * cross(body.center_m, body.velocity_m_s);
    sum.kinetic_j += 0.5 * (mass * dot(body.velocity_m_s, body.velocity_m_s) + dot(own, body.spin_rad_s));
  }
  return sum;
}

// Steps until something breaks; returns that step's events, or nothing if all stays whole for `seconds`.
std::optional<std::vector<synth::Event>> until_break(World& world, double seconds = 1) {
  while (world.time_s() < seconds) {
    const StepReport report = world.step();
    for (const std::string& notice : report.notices) {
      if (notice.find("broke into") != std::string::npos)
        return std::vector<synth::Event>(report.events.begin(), report.events.end());
    }
  }
  return {};
}

TEST(BreakingBodies, MomentumIsKeptOverTheStepOfTheBreak) {
  const PlateGrid grid{.along = 5, .across = 4};
  const modal::Bank bank = breaking_plate(grid);
  for (const std::optional<double> contact_time_s : {std::optional<double>(), {0.0}, {2e-4}}) {
    SceneDescription scene = in_space({.impulse_ns = 1e-3, .min_mass_kg = 0});
    scene.bodies[1].surface.contact_time_s = scene.bodies[0].surface.contact_time_s = contact_time_s;
    World world = world_of(scene, plate_objects(bank));
    Momentum before = momentum_of(world, grid);
    for (std::vector<BodyState> bodies = world.bodies(); bodies.size() == 2; bodies = world.bodies()) {
      ASSERT_LT(world.time_s(), 1);
      before = momentum_of(world, grid);
      world.step();
    }
    ASSERT_EQ(world.bodies().size(), 21u);
    const Momentum after = momentum_of(world, grid);
    EXPECT_LT(length(after.linear - before.linear), 1e-10 * length(before.linear));
    EXPECT_LT(length(after.angular - before.angular), 1e-10 * length(before.angular));
    EXPECT_LE(after.kinetic_j, before.kinetic_j);
  }
}

TEST(BreakingBodies, ABlowBelowTheImpulseLeavesTheBodyWhole) {
  const modal::Bank bank = breaking_plate();
  for (const double height_m : {0.15, 0.2, 0.4}) {
    SceneDescription scene = falling({}, height_m);
    scene.bodies[0].breaks.reset();
    World whole = world_of(scene, plate_objects(bank));
    double hardest_ns = 0;
    std::vector<test::Struck> strikes = test::run(whole, 0.5);
    for (const auto& strike : strikes) hardest_ns = std::max(hardest_ns, length(strike.impulse_ns));
    scene.bodies[0].breaks = Breaks{.impulse_ns = 1.001 * hardest_ns};
    World kept = world_of(scene, plate_objects(bank));
    EXPECT_FALSE(until_break(kept, 0.5));
    scene.bodies[0].breaks = Breaks{.impulse_ns = 0.999 * hardest_ns};
    World broken = world_of(scene, plate_objects(bank));
    EXPECT_TRUE(until_break(broken, 0.5));
    EXPECT_EQ(broken.bodies().size(), 12u);
  }
}

// The strike on the body ends with it. Its striker gets the part of the impulse that has acted by then, and then meets
// the piece under it, which does not sound as a second strike.
TEST(BreakingBodies, TheBlowIsHeardOnce) {
  const modal::Bank bank = breaking_plate();
  SceneDescription scene = in_space({.impulse_ns = 1e-3});
  scene.objects.push_back({.name = "bell"});
  scene.bodies[1].object = "bell";
  scene.bodies[1].surface.contact_time_s = scene.bodies[0].surface.contact_time_s = 2e-4;
  constexpr synth::ObjectNumber kBell = 50;
  std::vector<SoundingObject> objects = plate_objects(bank);
  objects.push_back(test::sounding("bell", kBell, test::box_bank({0.1, 0.1, 0.1}, 1)));
  World world = world_of(scene, objects);
  const auto events = until_break(world);
  ASSERT_TRUE(events);
  EXPECT_TRUE(std::ranges::is_sorted(*events, {}, &synth::Event::frame));
  scene.bodies[0].breaks.reset();
  World whole = world_of(scene, objects);
  const std::vector<test::Struck> as_whole = test::run(whole, world.time_s()),
                                  strikes = only<synth::verb::Strike>(*events);
  ASSERT_EQ(as_whole.size(), 2u);
  ASSERT_EQ(strikes.size(), 1u);
  EXPECT_EQ(strikes[0].object, kBell);
  const Vec3 all_ns = test::total_impulse(as_whole, kBell);
  const double share = length(strikes[0].impulse_ns) / length(all_ns);
  EXPECT_LT(length(strikes[0].impulse_ns - share * all_ns), 1e-12);
  EXPECT_GT(share, 0.3) << "the body breaks when the force is largest";
  EXPECT_LT(share, 0.7);
  for (const BodyState& body : world.bodies()) {
    if (body.name != "ball") continue;
    const double taken_ns = kBallMass_kg * (body.velocity_m_s.z + 3);
    EXPECT_NEAR(taken_ns, strikes[0].impulse_ns.z, 1e-9) << "what the ball has got beyond that is taken back";
  }

  const auto chokes = only<synth::verb::Choke>(*events);
  ASSERT_EQ(chokes.size(), 1u);
  EXPECT_EQ(chokes[0].object, 0u);
  EXPECT_EQ(chokes[0].frame, strikes[0].frame);
  const auto motions = only<synth::verb::Impart>(*events);
  ASSERT_EQ(motions.size(), 12u) << "one mode for each piece";
  for (const auto& motion : motions) EXPECT_GE(motion.frame, strikes[0].frame);
  const auto clicks = only<synth::verb::Click>(*events);
  EXPECT_EQ(clicks.size(), 2u);
  for (const auto& click : clicks) EXPECT_NEAR(length(click.impulse_ns), share * length(as_whole[0].impulse_ns), 1e-9);
  for (const auto& strike : test::run(world, 0.018)) EXPECT_NE(strike.object, 0u) << "the plate is gone";
}

TEST(BreakingBodies, PiecesThatOverlapStaySilentAndKeepTheirEnergy) {
  const PlateGrid grid{.along = 10, .across = 6, .hull = 1.6, .handover = 0};
  SceneDescription scene = in_space({.impulse_ns = 1e-3, .min_mass_kg = 0}, ball_body({0, 0, 0.05}));
  scene.bodies[1].surface.contact_time_s = scene.bodies[0].surface.contact_time_s = 0;  // the ball bounces off at once
  scene.bodies[0].velocity_m_s = scene.bodies[0].spin_rad_s = {};
  scene.bodies[1].velocity_m_s.x = 0;
  World world = world_of(scene, plate_objects(breaking_plate(grid)));
  ASSERT_TRUE(until_break(world));
  ASSERT_EQ(world.bodies().size(), 61u);
  const double before_j = momentum_of(world, grid).kinetic_j;
  const std::vector<synth::Event> later = test::run_all(world, 1);
  EXPECT_TRUE(later.empty()) << later.size() << " events";
  EXPECT_NEAR(momentum_of(world, grid).kinetic_j, before_j, 1e-9 * before_j);
}

// The floor's impulse is halved with the ball's, or the plate would jump.
TEST(BreakingBodies, ABreakOnTheFloorMakesNoEnergy) {
  const PlateGrid grid{.handover = 0.05F};
  for (const bool stacked : {false, true}) {
    SceneDescription scene = test::scene_of({plate_body({.impulse_ns = 0.05, .min_mass_kg = 0}), ball_body()}, 0.3);
    scene.bodies[0].position_m.z = 0.005;
    if (stacked) {  // a light thing between the plate and the floor
      scene.bodies[0].position_m.z = 0.0152;
      BodyDescription tile = ball_body();
      tile.name = "tile";
      tile.shape = {ShapeType::box, {0.29, 0.19, 0.01}, 0};
      tile.density_kg_m3 = 20;
      tile.position_m = {0, 0, 0.005};
      tile.velocity_m_s = {};
      scene.bodies.push_back(tile);
      scene.bodies[1].position_m.z = 0.07;
    }
    World world = world_of(scene, plate_objects(breaking_plate(grid)));
    ASSERT_TRUE(until_break(world));
    double fastest_m_s = 0;
    for (const BodyState& body : world.bodies()) fastest_m_s = std::max(fastest_m_s, length(body.velocity_m_s));
    EXPECT_LT(fastest_m_s, 3) << "the ball came with 3 m/s";
  }
}

TEST(BreakingBodies, PiecesFallRestAndFallSilent) {
  const PlateGrid grid;
  World world = world_of(falling({.impulse_ns = 1e-2}, 0.4), plate_objects(breaking_plate(grid)));
  const auto broke = until_break(world);
  ASSERT_TRUE(broke);
  const std::vector<test::Struck> landing = test::run(world, 1);
  EXPECT_GT(landing.size(), 6u) << "pieces strike the floor";
  for (const auto& strike : landing) EXPECT_GE(strike.object, 1u);
  test::run_all(world, 3);
  EXPECT_TRUE(test::run_all(world, 0.5).empty());
  ASSERT_EQ(world.bodies().size(), 12u);
  for (const BodyState& piece : world.bodies()) {
    EXPECT_GT(piece.center_m.z, 0) << piece.name;
    EXPECT_LT(piece.center_m.z, 0.1) << piece.name;
    EXPECT_EQ(piece.name, piece.object);
  }
  EXPECT_EQ(world.describe().size(), 12u);
  world.clear();
  EXPECT_TRUE(world.bodies().empty());
}

TEST(BreakingBodies, ABreakRepeatsBitForBit) {
  std::vector<synth::Event> first;
  for (int run = 0; run < 2; ++run) {
    World world = world_of(falling({.impulse_ns = 1e-2}, 0.3), plate_objects(breaking_plate()));
    const std::vector<synth::Event> events = test::run_all(world, 1);
    if (run == 0) first = events;
    EXPECT_GT(events.size(), 20u);
    EXPECT_TRUE(std::ranges::equal(events, first, test::same_bits));
  }
}

// A plate that slides ends its lasting contact before it breaks.
TEST(BreakingBodies, LastingContactsEndBeforeTheBreak) {
  SceneDescription scene = test::scene_of({plate_body({.impulse_ns = 0.05}), ball_body({0.5, 0, 0.55}, 0)}, 0);
  scene.bodies[0].position_m.z = 0.005;
  scene.bodies[0].velocity_m_s = {2, 0, 0};
  scene.bodies[1].velocity_m_s = {0, 0, 0};
  for (BodyDescription& body : scene.bodies) body.surface.friction = 0.1;
  World world = world_of(scene, plate_objects(breaking_plate()));
  std::vector<synth::Event> all;
  while (world.time_s() < 1 && world.bodies().size() == 2) {
    const StepReport report = world.step();
    all.insert(all.end(), report.events.begin(), report.events.end());
  }
  const auto chokes = only<synth::verb::Choke>(all);
  ASSERT_EQ(chokes.size(), 1u);
  std::vector<test::Told<synth::verb::Contact>> of_plate = only<synth::verb::Contact>(all);
  std::erase_if(of_plate, [](const auto& told) { return told.object != 0; });
  ASSERT_GT(of_plate.size(), 3u);
  EXPECT_EQ(of_plate.back().contact.force_n, Vec3{});
  EXPECT_LE(of_plate.back().frame, chokes[0].frame);
  const auto later = test::contacts(world, 0.1);
  EXPECT_TRUE(std::ranges::none_of(later, [](const auto& told) { return told.object == 0; }));
}

// Stress of the one mode, at two points of the skin.
std::shared_ptr<const modal::Fracture> with_stress(const modal::Bank& bank, float pa,
                                                   std::vector<modal::Vec3f> places) {
  modal::Fracture fracture = *bank.fracture;
  fracture.stress = {.positions = std::move(places), .stress = {}, .largest = {}};
  for (std::size_t p = 0; p < fracture.stress.positions.size(); ++p)
    fracture.stress.stress.insert(fracture.stress.stress.end(), {pa, 0, 0});
  fracture.stress.largest = {pa};
  fracture.skin_m2 = 0.1;
  fracture.strength = modal::Strength{.strength_pa = 5e7, .weibull_modulus = 5, .reference_area_m2 = 0.1};
  return std::make_shared<const modal::Fracture>(std::move(fracture));
}

TEST(BreakingBodies, StressAwayFromTheBlowBreaksABody) {
  modal::Bank bank = breaking_plate();
  // A blow of j on the mode, whose shape is 1 along z, bends it by j / omega; the impulse of the ball is 0.6 N s.
  const float stress = static_cast<float>(5e7 * 2 * std::numbers::pi * 440);
  const auto breaks = [&](std::vector<modal::Vec3f> places, double strength_pa) {
    bank.fracture = with_stress(bank, stress, std::move(places));
    World world = world_of(in_space({.strength_pa = strength_pa}), plate_objects(bank));
    return until_break(world, 0.5).has_value();
  };
  const std::vector<modal::Vec3f> far{{-0.15F, -0.1F, 0}}, near{{0.07F, 0.03F, 0.005F}};
  EXPECT_TRUE(breaks(far, 1e6));
  EXPECT_FALSE(breaks(far, 1e9));
  EXPECT_FALSE(breaks(near, 1e6)) << "the place of the blow is spared";
}

TEST(BreakingBodies, StrengthIsDrawnFromTheSeed) {
  modal::Bank bank = breaking_plate();
  bank.fracture = with_stress(bank, static_cast<float>(8e7 * 2 * std::numbers::pi * 440), {{-0.15F, -0.1F, 0}});
  int broken = 0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::optional<bool> outcome;
    for (int again = 0; again < 2; ++again) {
      SceneDescription scene = in_space({});
      scene.seed = static_cast<std::uint64_t>(seed);
      World world = world_of(scene, plate_objects(bank));
      const bool breaks = until_break(world, 0.1).has_value();
      EXPECT_EQ(outcome.value_or(breaks), breaks);
      outcome = breaks;
    }
    broken += *outcome;
  }
  EXPECT_GT(broken, 0);
  EXPECT_LT(broken, kSeeds);
}

// With energy for the coarse pattern only, that one is taken; its pieces are numbered after those of the other.
TEST(BreakingBodies, TheEnergyOfTheVibrationLimitsTheNumberOfPieces) {
  modal::Bank bank = breaking_plate({.along = 2, .across = 1});
  modal::Fracture fracture = *bank.fracture;
  fracture.patterns.push_back(breaking_plate({.along = 6, .across = 5}).fracture->patterns[0]);
  fracture.patterns[1].crack_area_m2 = 1e-2;
  fracture.crack_energy_j_m2 = 10;
  bank.fracture = std::make_shared<const modal::Fracture>(fracture);
  const auto pieces = [&](double factor) {
    World world = world_of(in_space({.impulse_ns = 1e-3, .crack_energy_factor = factor}), plate_objects(bank));
    EXPECT_TRUE(until_break(world));
    EXPECT_EQ(world.bodies()[1].name, world.bodies().size() == 3 ? "plate.0" : "plate.2");
    return world.bodies().size() - 1;
  };
  EXPECT_EQ(pieces(0), 30u);
  EXPECT_EQ(pieces(1e-3), 30u);
  EXPECT_EQ(pieces(1000), 2u);
}

TEST(BreakingBodies, LightPiecesHaveNoBody) {
  World world = world_of(in_space({.impulse_ns = 1e-3, .min_mass_kg = 0.1}), plate_objects(breaking_plate()));
  const auto events = until_break(world);
  ASSERT_TRUE(events);
  EXPECT_EQ(world.bodies().size(), 1u);
  EXPECT_EQ(only<synth::verb::Impart>(*events).size(), 12u);
}

TEST(BreakingBodies, ABodyStaysWholeWithoutRoomForItsPieces) {
  World world = world_of(in_space({.impulse_ns = 1e-3}), plate_objects(breaking_plate()));
  BodyDescription far = ball_body({100, 0, 0}, 0);
  far.velocity_m_s = {};
  for (std::size_t k = 2; k + 10 < kMaxBodies; ++k) {
    far.position_m.y = 0.1 * static_cast<double>(k);
    ASSERT_TRUE(world.spawn(far));
  }
  std::vector<std::string> notices;
  while (world.time_s() < 0.1) {
    const StepReport report = world.step();
    notices.insert(notices.end(), report.notices.begin(), report.notices.end());
  }
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_NE(notices[0].find("no room"), std::string::npos);
  EXPECT_EQ(world.bodies()[0].name, "plate");
}

TEST(BreakingBodies, RefusalsSayWhatToDo) {
  const modal::Bank bank = breaking_plate();
  const auto refused = [&](const SceneDescription& scene, const modal::Bank& of, const char* word) {
    const auto world = World::create(scene, plate_objects(of), 48000);
    ASSERT_FALSE(world) << word;
    EXPECT_NE(world.error().message.find(word), std::string::npos) << world.error().message;
    EXPECT_NE(world.error().message.find("plate"), std::string::npos) << world.error().message;
  };
  const auto with = [&](const auto& change) {
    SceneDescription scene = in_space({.impulse_ns = 1});
    change(scene);
    return scene;
  };
  refused(with([](auto& s) { s.bodies[0].fixed = true; }), bank, "fixed");
  refused(with([](auto& s) { s.bodies[0].two_way = true; }), bank, "two-way");
  refused(with([](auto& s) { s.bodies[0].object.clear(); }), bank, "needs an object");
  refused(with([](auto& s) { s.bodies[0].mass.emplace().mass_kg = 1; }), bank, "mass");
  refused(with([](auto& s) { s.bodies[1].object = "plate"; }), bank, "object of its own");
  refused(with([](auto& s) { s.bodies[0].breaks->impulse_ns = -1; }), bank, "impulse_ns");
  refused(with([](auto& s) { s.bodies[0].breaks->strength_pa = 1; }), bank, "strength_pa");
  refused(with([](auto& s) {
            s.joints.push_back({.name = "j", .type = JointType::ball, .body = "ball", .other = "plate"});
          }),
          bank, "joined");
  refused(with([](auto& s) { s.bodies[0].breaks = Breaks{}; }), bank, "impulse_ns");
  refused(with([](auto& s) { s.bodies[0].breaks->strength_pa = 1e7; }), bank, "stress");
  modal::Bank other = bank;
  other.held = true;
  refused(with([](auto&) {}), other, "supports");
  other = bank;
  other.nonlinear.emplace();
  refused(with([](auto&) {}), other, "exchange");
}

TEST(BreakingBodies, ABankWithoutPiecesIsRefused) {
  modal::Bank plain = breaking_plate();
  plain.fracture.reset();
  const auto world = World::create(in_space({.impulse_ns = 1}), std::vector{test::sounding("plate", 0, plain)}, 48000);
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("[shatter]"), std::string::npos) << world.error().message;
}

TEST(BreakingBodies, ASceneFileSaysWhatBreaks) {
  const std::string object = "[[object]]\nname = \"a\"\nbank = \"#0\"\n[[body]]\nname = \"b\"\nobject = \"a\"\n";
  const auto read = [&](const std::string& breaks) { return parse_scene(object + breaks, "scene.glb", {}); };
  const auto plain = read("breaks = true");
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->bodies[0].breaks, Breaks{});
  EXPECT_FALSE(read("breaks = false")->bodies[0].breaks);
  const auto all = read("breaks = { impulse_ns = 2, strength_pa = 3e7, crack_energy_factor = 1, min_mass_kg = 1e-3 }");
  ASSERT_TRUE(all) << all.error().message;
  const Breaks wanted{.impulse_ns = 2, .strength_pa = 3e7, .crack_energy_factor = 1, .min_mass_kg = 1e-3};
  EXPECT_EQ(all->bodies[0].breaks, wanted);
  for (const auto& scene : {plain, all}) {
    SceneDescription saved = *scene;
    saved.objects[0].bank = "#0";
    const auto again = parse_scene(to_toml(saved), "scene.glb", {});
    ASSERT_TRUE(again) << again.error().message << to_toml(saved);
    EXPECT_EQ(again->bodies[0].breaks, scene->bodies[0].breaks);
  }
  EXPECT_FALSE(read("breaks = 3"));
  EXPECT_FALSE(read("breaks = { impulse = 3 }"));
  EXPECT_FALSE(read("breaks = { impulse_ns = 0 }"));
}

}  // namespace
}  // namespace ringdown::scene
