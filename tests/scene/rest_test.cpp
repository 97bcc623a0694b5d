// What rests on what: told once, with the weight it bears, and taken back when it moves.
#include "engine/scene/world.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace ringdown::scene::rest_test {
namespace {

using test::body_of;
using test::box_bank;
using test::scene_of;
using test::sounding;

constexpr Vec3 kSize{0.1, 0.1, 0.1};
constexpr double kGravity = 9.81, kDamping_s_m = 1.5;

// What lies on each object, as told up to now, and how often it was told.
struct Heard {
  std::map<synth::ObjectNumber, modal::Dampers> dampers;
  int times = 0;

  void run(World& world, double seconds) {
    for (const double end = world.time_s() + seconds; world.time_s() < end;) {
      for (const RestDamping& damping : world.step().rest_dampings) {
        ++times;
        for (const auto& [number, damper] : damping.dampers) {
          EXPECT_GE(number, modal::kFirstSceneDamper);
          EXPECT_LT(number, modal::kMaxDampers);
          auto& all = dampers[damping.object];
          if (damper.damping_ns_m > 0) {
            all[number] = damper;
          } else {
            all.erase(number);
          }
        }
      }
    }
  }

  [[nodiscard]] double damping(synth::ObjectNumber object) {
    double sum = 0;
    for (const auto& [number, damper] : dampers[object]) sum += damper.damping_ns_m;
    return sum;
  }
};

World world_of(const SceneDescription& scene, const std::vector<SoundingObject>& objects) {
  auto world = World::create(scene, objects, 48000);
  if (!world) throw std::runtime_error(world.error().message);
  return std::move(*world);
}

TEST(Rest, ABoxIsDampedByTheFloorThatBearsItsWeight) {
  World world =
      world_of(scene_of({body_of("a", ShapeType::box, {0, 0, 0.05})}, 0.3), {sounding("a", 3, box_bank(kSize, 2))});
  Heard heard;
  heard.run(world, 2);
  EXPECT_EQ(heard.dampers[3].size(), 4u) << "its four corners";
  EXPECT_NEAR(heard.damping(3) / (kDamping_s_m * 0.7 * 2 * kGravity), 1, 0.03);
  for (const auto& [number, damper] : heard.dampers[3]) {
    EXPECT_NEAR(damper.point_m.z, -0.05, 0.001);
    EXPECT_NEAR(std::abs(damper.point_m.x), 0.05, 0.001);
    EXPECT_NEAR(std::abs(damper.direction.z), 1, 1e-6);
  }
  const int told = heard.times;
  EXPECT_LE(told, 2);
  heard.run(world, 10);
  EXPECT_EQ(heard.times, told) << "it sleeps, and goes on resting";
}

TEST(Rest, DampingByTheFloorEndsWhenTheBodyIsThrownUp) {
  World world =
      world_of(scene_of({body_of("a", ShapeType::box, {0, 0, 0.0501})}, 0.3), {sounding("a", 0, box_bank(kSize, 2))});
  Heard heard;
  heard.run(world, 3);
  EXPECT_GT(heard.damping(0), 0);
  ASSERT_TRUE(world.push(world.bodies()[0].id, {0, 0, 2 * 3.0}));
  heard.run(world, 0.2);
  EXPECT_EQ(heard.damping(0), 0);
  heard.run(world, 3);
  EXPECT_GT(heard.damping(0), 0) << "it has come down again";
}

TEST(Rest, TheFloorDampsNothingThatRollsOrSlides) {
  BodyDescription ball = body_of("a", ShapeType::sphere, {0, 0, 0.0866});
  ball.velocity_m_s = {1, 0, 0};
  BodyDescription box = body_of("b", ShapeType::box, {0, 1, 0.0501});
  box.velocity_m_s = {3, 0, 0};
  box.surface.friction = 0.01;
  World world = world_of(scene_of({ball, box}, 0.3),
                         {sounding("a", 0, box_bank(kSize, 1)), sounding("b", 1, box_bank(kSize, 1))});
  Heard heard;
  heard.run(world, 1);
  EXPECT_EQ(heard.times, 0);
}

TEST(Rest, InATowerBothFacesOfABoxAreTouched) {
  std::vector<BodyDescription> bodies;
  std::vector<SoundingObject> objects;
  for (int k = 0; k < 3; ++k) {
    const std::string name = "b" + std::to_string(k);
    bodies.push_back(body_of(name, ShapeType::box, {0, 0, 0.0501 + 0.1001 * k}));
    objects.push_back(sounding(name, static_cast<std::uint32_t>(k), box_bank(kSize, 1)));
  }
  World world = world_of(scene_of(bodies, 0), objects);
  Heard heard;
  heard.run(world, 3);
  const double weight = kDamping_s_m * kGravity;
  EXPECT_NEAR(heard.damping(0), (3 + 2) * weight, 0.1 * 5 * weight);
  EXPECT_NEAR(heard.damping(1), (2 + 1) * weight, 0.1 * 3 * weight);
  EXPECT_NEAR(heard.damping(2), 1 * weight, 0.1 * weight);
  EXPECT_EQ(heard.dampers[1].size(), 8u);
}

TEST(Rest, DampingByTheFloorPausesWhileAnotherBodyPlaysTheObject) {
  World world =
      world_of(scene_of({body_of("a", ShapeType::box, {0, 0, 0.05})}, 0.3), {sounding("a", 0, box_bank(kSize, 2))});
  Heard heard;
  heard.run(world, 3);
  const double alone = heard.damping(0);
  EXPECT_GT(alone, 0);
  BodyDescription box{.name = "box"};
  box.object = "a";
  box.position_m = {2, 0, 1};
  ASSERT_TRUE(world.spawn(box));
  heard.run(world, 0.1);
  EXPECT_EQ(heard.damping(0), 0);
  world.clear_spawned();
  heard.run(world, 0.1);
  EXPECT_EQ(heard.damping(0), alone);
}

TEST(Rest, DampingByTheFloorEndsWithTheBodyOrWhatItLiesOn) {
  for (const bool lower : {true, false}) {
    std::vector<BodyDescription> bodies{body_of("a", ShapeType::box, {0, 0, 0.05})};
    World world =
        world_of(scene_of(bodies, 0), {sounding("a", 0, box_bank(kSize, 1)), sounding("b", 1, box_bank(kSize, 1))});
    BodyDescription box{.name = "box"};
    box.object = "b";
    box.position_m = lower ? Vec3{0, 0, 0.151} : Vec3{2, 0, 0.05};
    ASSERT_TRUE(world.spawn(box));
    Heard heard;
    heard.run(world, 4);
    EXPECT_GT(heard.damping(1), 0);
    const double before = heard.damping(0);
    world.clear_spawned();
    heard.run(world, 0.5);
    EXPECT_EQ(heard.damping(1), 0);
    if (lower) {
      EXPECT_LT(heard.damping(0), 0.6 * before) << "it bears itself alone";
    } else {
      EXPECT_EQ(heard.damping(0), before);
    }
  }
}

TEST(Rest, TheFloorDampsNothingWhereSeveralBodiesShareAnObjectOrTheSceneSaysSo) {
  const std::vector<SoundingObject> one{sounding("a", 0, box_bank(kSize, 1))};
  for (const bool shared : {true, false}) {
    SceneDescription scene = scene_of({body_of("a", ShapeType::box, {0, 0, 0.0501})}, 0);
    if (shared) {
      scene.bodies.push_back(body_of("a", ShapeType::box, {1, 0, 0.0501}));
      scene.bodies.back().name = "another";
    } else {
      scene.contact.rest_damping_s_m = 0;
    }
    World world = world_of(scene, one);
    Heard heard;
    heard.run(world, 2);
    EXPECT_EQ(heard.times, 0) << shared;
  }
}

}  // namespace
}  // namespace ringdown::scene::rest_test
