// What happens while a scene runs: spawning, clearing, new banks, poisoned bodies, limits.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

namespace ringdown::scene::runtime_test {
namespace {

using test::body_of;
using test::box_bank;
using test::run;
using test::scene_of;
using test::sounding;
using test::world_of;

constexpr Vec3 kSize{0.1, 0.1, 0.1};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

World empty_world() { return world_of(scene_of({}), {sounding("bell", 4, box_bank(kSize, 1))}); }

BodyDescription silent_ball() {
  BodyDescription ball{.name = "sphere", .shape = {ShapeType::sphere}};
  ball.position_m = {0, 0, 0.3};
  ball.shape.radius_m = 0.02;
  ball.density_kg_m3 = 2500;
  return ball;
}

TEST(Spawn, ASpawnedBoxOfAnObjectFallsAndRings) {
  World world = empty_world();
  BodyDescription box{.name = "box"};
  box.object = "bell";
  box.position_m = {0, 0, 0.5};
  const auto id = world.spawn(box);
  ASSERT_TRUE(id) << id.error().message;
  const auto strikes = run(world, 2);
  ASSERT_FALSE(strikes.empty());
  EXPECT_EQ(strikes.front().object, 4u);
  EXPECT_EQ(world.bodies()[0].object, "bell");
}

TEST(Spawn, ASphereOfAnObjectAndSilentOnesToo) {
  World world = empty_world();
  BodyDescription ball{.name = "sphere", .shape = {ShapeType::sphere}};
  ball.object = "bell";
  ball.position_m = {1, 0, 0.5};
  EXPECT_TRUE(world.spawn(ball));
  ASSERT_TRUE(world.spawn(silent_ball()));
  EXPECT_EQ(world.bodies()[1].object, "");
}

TEST(Spawn, ABodyThatCannotBeIsNotSpawned) {
  World world = empty_world();
  const auto refused = [&](auto body, const std::string& word) {
    const auto id = world.spawn(body);
    ASSERT_FALSE(id) << word;
    EXPECT_NE(id.error().message.find(word), std::string::npos) << id.error().message;
  };
  auto ball = silent_ball();
  ball.object = "gong";
  refused(ball, "'gong'");
  ball = silent_ball();
  ball.position_m.x = kNan;
  refused(ball, "position_m");
  ball = silent_ball();
  ball.velocity_m_s.y = 1e9;
  refused(ball, "velocity_m_s");
  ball = silent_ball();
  ball.shape.radius_m = -1;
  refused(ball, "size");
  ball.shape.radius_m = 0;
  refused(ball, "size");
  ball = silent_ball();
  ball.density_kg_m3 = 0;
  refused(ball, "density");
  EXPECT_TRUE(world.bodies().empty());
}

TEST(Spawn, BodiesAreSpawnedUpToTheLimitAndNotBeyond) {
  World world = empty_world();
  auto ball = silent_ball();
  for (std::size_t k = 0; k < kMaxBodies; ++k) {
    ball.position_m = {0.1 * static_cast<double>(k % 32), 0.1 * static_cast<double>(k / 32), 1};
    ASSERT_TRUE(world.spawn(ball));
  }
  const auto more = world.spawn(ball);
  ASSERT_FALSE(more);
  EXPECT_NE(more.error().message.find("full"), std::string::npos);
  world.step();
  world.clear();
  EXPECT_TRUE(world.spawn(ball));
}

TEST(Remove, WhatStoodOnABodyFallsAndABodyComesBackWhereItWasAtRest) {
  SceneDescription scene = scene_of({body_of("shelf", ShapeType::box, {0, 0, 1}), body_of("bell", ShapeType::box, {})});
  scene.bodies[0].fixed = true;
  scene.bodies[1].position_m = {0, 0, 1.101};
  World world = world_of(scene, {sounding("shelf", 3, box_bank(kSize, 1)), sounding("bell", 4, box_bank(kSize, 1))});
  run(world, 2);
  ASSERT_NEAR(world.bodies()[1].position_m.z, 1.1, 1e-3);
  ASSERT_TRUE(world.remove(0));
  ASSERT_EQ(world.bodies().size(), 1u);
  EXPECT_EQ(world.bodies()[0].id, 1);
  run(world, 0.2);
  const double falling_m = world.bodies()[0].position_m.z;
  EXPECT_NEAR(falling_m, 1.1 - 9.81 / 2 * 0.2 * 0.2, 0.01) << "as nothing holds it any more";
  ASSERT_TRUE(world.remove(1));
  run(world, 1);
  ASSERT_TRUE(world.restore(1));
  const BodyState back = world.bodies()[0];
  EXPECT_EQ(back.id, 1);
  EXPECT_EQ(back.name, "bell");
  EXPECT_NEAR(back.position_m.z, falling_m, 1e-9);
  EXPECT_LT(length(back.velocity_m_s), 0.02) << "at rest";
  EXPECT_FALSE(run(world, 2).empty()) << "it falls to the floor and rings";
  ASSERT_TRUE(world.restore(0));
  run(world, 0.1);
  EXPECT_EQ(world.bodies()[0].position_m, (Vec3{0, 0, 1})) << "the shelf is fixed again";
}

TEST(Remove, OnlyBodiesThatAreThereAreRemovedAndOnlyRemovedOnesRestored) {
  World world = empty_world();
  const auto id = world.spawn(silent_ball());
  ASSERT_TRUE(id);
  const auto no_word = [](const Result<void>& done, const char* word) {
    return !done && done.error().message.find(word) != std::string::npos;
  };
  EXPECT_TRUE(no_word(world.restore(*id), "cannot restore"));
  EXPECT_TRUE(no_word(world.remove(*id + 1), "cannot remove"));
  ASSERT_TRUE(world.remove(*id));
  EXPECT_TRUE(no_word(world.remove(*id), "cannot remove"));
  const auto other = world.spawn(silent_ball());
  ASSERT_TRUE(other);
  EXPECT_NE(*other, *id) << "its number is kept for it";
  ASSERT_TRUE(world.restore(*id));
  EXPECT_TRUE(no_word(world.restore(*id), "cannot restore"));
  ASSERT_TRUE(world.remove(*id));
  world.clear();
  EXPECT_TRUE(no_word(world.restore(*id), "cannot restore"));
}

TEST(Remove, ABodyWhoseObjectWasFreedComesBackOnceTheObjectIsLoadedAgain) {
  SceneDescription scene = scene_of({body_of("bell", ShapeType::convex, {0, 0, 1})});
  World world = world_of(scene, {sounding("bell", 4, box_bank(kSize, 1))});
  ASSERT_TRUE(world.remove(0));
  world.remove_object(4);
  const auto refused = world.restore(0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("no object 'bell' is loaded"), std::string::npos) << refused.error().message;
  EXPECT_TRUE(world.bodies().empty());
  run(world, 0.1);
  EXPECT_FALSE(world.restore(0)) << "it is still kept, and still refused";
  ASSERT_TRUE(world.set_object(sounding("bell", 9, box_bank(2 * kSize, 1))));
  ASSERT_TRUE(world.restore(0));
  ASSERT_EQ(world.bodies().size(), 1u);
  EXPECT_EQ(world.bodies()[0].id, 0);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 1, 1e-3);
  EXPECT_FALSE(run(world, 3).empty()) << "it falls to the floor and rings";
  EXPECT_NEAR(world.bodies()[0].position_m.z, kSize.z, 2e-3) << "its collider has the size of the new bank";
}

TEST(Place, ABodyIsPutElsewhereAtRestAndWhatStoodOnItFalls) {
  SceneDescription scene = scene_of({body_of("shelf", ShapeType::box, {0, 0, 1}), body_of("bell", ShapeType::box, {})});
  scene.bodies[0].fixed = true;
  scene.bodies[1].position_m = {0, 0, 1.101};
  World world = world_of(scene, {sounding("shelf", 3, box_bank(kSize, 1)), sounding("bell", 4, box_bank(kSize, 1))});
  run(world, 3);
  ASSERT_NEAR(world.bodies()[1].position_m.z, 1.1, 1e-3) << "asleep on the shelf";
  const Rotation upright = Rotation::from_xyzw(0, 0, std::sqrt(0.5), std::sqrt(0.5));
  ASSERT_TRUE(world.place(0, {{2, 0, 1}, upright}));
  EXPECT_EQ(world.bodies()[0].position_m, (Vec3{2, 0, 1}));
  EXPECT_NEAR(world.bodies()[0].rotation.z, std::sqrt(0.5), 1e-12);
  run(world, 0.2);
  EXPECT_NEAR(world.bodies()[1].position_m.z, 1.1 - 9.81 / 2 * 0.2 * 0.2, 0.01) << "as nothing holds it any more";
  ASSERT_TRUE(world.place(1, {{2, 0, 1.101}, {}}));
  EXPECT_EQ(world.bodies()[1].velocity_m_s, Vec3{});
  run(world, 2);
  EXPECT_NEAR(world.bodies()[1].position_m.z, 1.1, 1e-3) << "the shelf carries it where it is now";
}

TEST(Place, BodiesThatWaitBeginThereAndOthersAreRefused) {
  SceneDescription scene =
      scene_of({body_of("bell", ShapeType::box, {0, 0, 1}), body_of("late", ShapeType::box, {0, 3, 1})});
  scene.bodies[1].start_s = 0.5;
  scene.joints.push_back({.name = "hook", .type = JointType::ball, .body = "bell", .anchor_m = {0, 0, 1.2}});
  World world = world_of(scene, {sounding("bell", 4, box_bank(kSize, 1)), sounding("late", 5, box_bank(kSize, 1))});
  ASSERT_TRUE(world.place(1, {{5, 0, 1}, {}}));
  run(world, 0.6);
  EXPECT_NEAR(world.bodies()[1].position_m.x, 5, 1e-6);
  EXPECT_NEAR(world.bodies()[1].position_m.z, 1 - 9.81 / 2 * 0.1 * 0.1, 5e-3);
  const auto why = [](const Result<void>& done) { return done ? std::string() : done.error().message; };
  EXPECT_NE(why(world.place(0, {})).find("a joint holds it"), std::string::npos);
  EXPECT_NE(why(world.place(7, {})).find("no body 7"), std::string::npos);
  EXPECT_NE(why(world.place(1, {{}, Rotation::from_xyzw(0, 0, 0, 0)})).find("its rotation is 0"), std::string::npos);
  EXPECT_NE(why(world.place(1, {{0, 0, 2000}, {}})).find("within 1000 m"), std::string::npos);
}

TEST(Clear, ClearingRemovesSpawnedBodiesAndTheSceneStays) {
  World world =
      world_of(scene_of({body_of("bell", ShapeType::box, {0, 0, 1})}), {sounding("bell", 4, box_bank(kSize, 1))});
  ASSERT_TRUE(world.spawn(silent_ball()));
  world.clear_spawned();
  ASSERT_EQ(world.bodies().size(), 1u);
  EXPECT_EQ(world.bodies()[0].name, "bell");
  world.clear();
  EXPECT_TRUE(world.bodies().empty());
  EXPECT_EQ(run(world, 0.1).size(), 0u);
}

TEST(Clear, AStepThatIsGivenUpLooksForNoContacts) {
  World world = world_of(scene_of({body_of("bell", ShapeType::box, {0, 0, kSize.z / 2})}),
                         {sounding("bell", 4, box_bank(kSize, 1))});
  std::atomic<int> given_up = 0;
  const auto height_m = [&] {
    for (int k = 0; k < 50; ++k) world.step(&given_up);
    return world.bodies()[0].position_m.z;
  };
  const double before_m = height_m();
  EXPECT_NEAR(before_m, kSize.z / 2, 1e-4);
  ++given_up;
  ASSERT_TRUE(world.push(0, {0, 0, -0.01})) << "it wakes";
  EXPECT_LT(height_m(), before_m - 0.04) << "it falls through the floor";
}

TEST(Start, ABodyEntersAtItsTimeAndThenFallsAsAnyOther) {
  const double height = 0.2, fall_s = std::sqrt(2 * height / 9.81);
  std::vector<synth::Frame> landed;
  for (const double start_s : {0.0, 1.5}) {
    BodyDescription body = body_of("a", ShapeType::box, {0, 0, 0.05 + height});
    body.start_s = start_s;
    SceneDescription scene = scene_of({body});
    scene.step_s = 1.0 / 1000;
    World world = world_of(scene, {sounding("a", 4, box_bank(kSize, 1))});
    EXPECT_EQ(world.bodies()[0].waiting, start_s > 0);
    const auto strikes = run(world, start_s + fall_s + 0.01);
    ASSERT_FALSE(strikes.empty());
    EXPECT_FALSE(world.bodies()[0].waiting);
    landed.push_back(strikes.front().frame);
  }
  EXPECT_EQ(landed[1] - landed[0], 72000);
}

TEST(Start, AWaitingBodyIsInNobodysWay) {
  BodyDescription falling = body_of("a", ShapeType::box, {0, 0, 0.3}), late = body_of("b", ShapeType::box, {0, 0, 0.1});
  late.start_s = 60;
  World world =
      world_of(scene_of({falling, late}), {sounding("a", 4, box_bank(kSize, 1)), sounding("b", 5, box_bank(kSize, 1))});
  run(world, 2);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 0.05, 0.002);
  EXPECT_EQ(world.bodies()[1].position_m, (Vec3{0, 0, 0.1}));
  EXPECT_FALSE(world.push(world.bodies()[1].id, {1, 0, 0}));
}

TEST(Clear, ABodyThatSleptOnAClearedBodyFalls) {
  std::vector<BodyDescription> bodies{body_of("bell", ShapeType::box, {0, 0, 0.15})};
  World world = world_of(scene_of(bodies, 0), {sounding("bell", 4, box_bank(kSize, 1))});
  BodyDescription table{.name = "box"};
  table.shape.size_m = kSize;
  table.density_kg_m3 = 1000;
  table.position_m = {0, 0, 0.05};
  ASSERT_TRUE(world.spawn(table));
  run(world, 2);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 0.15, 0.002);
  world.clear_spawned();
  run(world, 1);
  EXPECT_NEAR(world.bodies()[0].position_m.z, 0.05, 0.002);
}

TEST(Objects, ANewBankGivesItsMassAndShapeWhereTheBodyIs) {
  BodyDescription body = body_of("bell", ShapeType::box, {0, 0, 1});
  body.rotation = about({1, 0, 0}, 0.3);
  World world = world_of(scene_of({body}), {sounding("bell", 4, box_bank(kSize, 1))});
  run(world, 0.1);
  const Vec3 before = world.bodies()[0].position_m;
  ASSERT_TRUE(world.set_object(sounding("bell", 4, box_bank(kSize, 3, {0.2, 0, 0}))));
  EXPECT_NEAR(length(world.bodies()[0].position_m - before), 0, 1e-12);
  ASSERT_TRUE(world.push(world.bodies()[0].id, {6, 0, 0}));
  EXPECT_DOUBLE_EQ(world.bodies()[0].velocity_m_s.x, 2) << "6 N s on 3 kg";
}

TEST(Objects, ABankThatCannotBeABodyChangesNothing) {
  World world =
      world_of(scene_of({body_of("bell", ShapeType::box, {0, 0, 1})}), {sounding("bell", 4, box_bank(kSize, 1))});
  modal::Bank bad = box_bank(kSize, 1);
  bad.mass->mass_kg = -1;
  EXPECT_FALSE(world.set_object(sounding("bell", 4, bad)));
  ASSERT_TRUE(world.push(world.bodies()[0].id, {6, 0, 0}));
  EXPECT_DOUBLE_EQ(world.bodies()[0].velocity_m_s.x, 6);
}

TEST(Objects, AnObjectThatHasGoneIsSilentUntilItIsBack) {
  World world = world_of(scene_of({body_of("bell", ShapeType::sphere, {0, 0, 0.3})}, 0.95),
                         {sounding("bell", 4, box_bank(kSize, 1))});
  EXPECT_FALSE(run(world, 1).empty());
  world.remove_object(4);
  EXPECT_TRUE(run(world, 1).empty());
  ASSERT_TRUE(world.set_object(sounding("bell", 7, box_bank(kSize, 1))));
  const auto strikes = run(world, 1);
  ASSERT_FALSE(strikes.empty());
  EXPECT_EQ(strikes.front().object, 7u);
}

TEST(AbsurdInput, ABodyBeyondWhatIsRealGoesBackAndThenAway) {
  World world =
      world_of(scene_of({body_of("bell", ShapeType::box, {0, 0, 1})}), {sounding("bell", 4, box_bank(kSize, 1))});
  const BodyId id = world.bodies()[0].id;
  for (int k = 0; k < kMaxResets; ++k) {
    ASSERT_TRUE(world.push(id, {9e5, 0, 0}));
    const auto report = world.step();
    ASSERT_EQ(report.notices.size(), 1u);
    EXPECT_NE(report.notices[0].find("'bell' moved impossibly fast or far"), std::string::npos) << report.notices[0];
    EXPECT_EQ(world.bodies()[0].position_m, (Vec3{0, 0, 1}));
    EXPECT_EQ(world.bodies()[0].velocity_m_s, (Vec3{}));
  }
  ASSERT_TRUE(world.push(id, {9e5, 0, 0}));
  EXPECT_NE(world.step().notices[0].find("removed"), std::string::npos);
  EXPECT_TRUE(world.bodies().empty());
}

TEST(AbsurdInput, ABodyThatFallsOffTheWorldIsRemovedAndReported) {
  auto scene = scene_of({body_of("bell", ShapeType::box, {0, 0, -900})});
  scene.statics.clear();
  World world = world_of(scene, {sounding("bell", 4, box_bank(kSize, 1))});
  std::size_t notices = 0;
  while (world.time_s() < 10) notices += world.step().notices.size();
  EXPECT_EQ(notices, 1u);
  EXPECT_TRUE(world.bodies().empty());
}

TEST(AbsurdInput, APushThatIsNotANumberIsRefused) {
  World world =
      world_of(scene_of({body_of("bell", ShapeType::box, {0, 0, 1})}), {sounding("bell", 4, box_bank(kSize, 1))});
  EXPECT_FALSE(world.push(0, {kNan, 0, 0}));
  EXPECT_FALSE(world.push(0, {1e300, 0, 0}));
  EXPECT_FALSE(world.push(77, {1, 0, 0}));
}

TEST(AbsurdInput, ADescriptionFilledWithNonsenseIsRefusedBeforeOdeSeesIt) {
  const auto refused = [](const std::string& word, auto spoil) {
    SceneDescription scene = scene_of({body_of("bell", ShapeType::box, {0, 0, 1})});
    spoil(scene);
    const auto world = World::create(scene, std::vector{sounding("bell", 4, box_bank(kSize, 1))}, 48000);
    ASSERT_FALSE(world) << word;
    EXPECT_NE(world.error().message.find(word), std::string::npos) << world.error().message;
  };
  refused("gravity", [](auto& scene) { scene.gravity_m_s2.z = kNan; });
  refused("step_s", [](auto& scene) { scene.step_s = 0; });
  refused("spring", [](auto& scene) { scene.contact.spring_n_m = -1; });
  refused("position_m", [](auto& scene) { scene.bodies[0].position_m.x = kNan; });
  refused("rotation", [](auto& scene) { scene.bodies[0].rotation = Rotation::from_xyzw(0, 0, 0, 0); });
  refused("spin_rad_s", [](auto& scene) { scene.bodies[0].spin_rad_s.x = 1e12; });
  refused("restitution", [](auto& scene) { scene.bodies[0].surface.restitution = 1.5; });
  refused("normal", [](auto& scene) { scene.statics[0].normal = {}; });
  refused("size_m", [](auto& scene) { scene.statics[0].type = StaticType::box; });
  refused("no object", [](auto& scene) { scene.bodies[0].object = "gong"; });
  refused("named", [](auto& scene) { scene.bodies.push_back(scene.bodies[0]); });
  refused("pan", [](auto& scene) { scene.objects[0].pan = 2; });
  refused("more than", [](auto& scene) { scene.statics.resize(kMaxStatics + 1); });
}

TEST(Stress, OverlappingBodiesOfEveryShapePartWithoutAFlight) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 8; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, static_cast<ShapeType>(k % 4), {0.01 * k, 0.02 * (k % 3), 0.06}));
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank(kSize, k % 2 ? 0.01 : 10)));
  }
  World world = world_of(scene_of(bodies), objects);
  run(world, 3);
  EXPECT_EQ(world.bodies().size(), 8u);
  for (const BodyState& body : world.bodies()) EXPECT_LT(body.position_m.z, 1);
}

TEST(Stress, APileUsesTheIterativeSolverAndIsStillTheSameTwice) {
  const auto pile = [] {
    World world = empty_world();
    BodyDescription box{.name = "box"};
    box.object = "bell";
    for (int k = 0; k < 60; ++k) {
      box.position_m = {0.09 * (k % 4), 0.09 * (k / 4 % 4), 0.1 + 0.11 * (k / 16)};
      EXPECT_TRUE(world.spawn(box));
    }
    const auto strikes = run(world, 1);
    return std::pair(strikes.size(), world.bodies().back().position_m);
  };
  const auto first = pile(), second = pile();
  EXPECT_GT(first.first, 100u);
  EXPECT_EQ(first.first, second.first);
  EXPECT_EQ(first.second, second.second);
}

}  // namespace
}  // namespace ringdown::scene::runtime_test
