// A scene's capacities: at the limit all is well, one past it is refused or counted.
#include "engine/scene/ode_contact_joints.h"
#include "engine/scene/lasting_events.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace ringdown::scene {
namespace {

using test::box_bank;
using test::scene_of;
using test::sounding;
using test::world_of;

constexpr Vec3 kSize{0.1, 0.1, 0.1};

World weightless_world() {
  SceneDescription scene = scene_of({});
  scene.gravity_m_s2 = {};
  scene.step_s = 1.0 / 500;
  scene.contact.clicks = false;
  return world_of(scene, {sounding("bell", 4, box_bank(kSize, 1))});
}

// Two balls that meet in the third step, and ring both.
void spawn_pair(World& world, Vec3 place, Vec3 first_velocity, Vec3 second_velocity) {
  BodyDescription ball{.name = "sphere", .shape = {ShapeType::sphere}};
  ball.object = "bell";
  ball.shape.radius_m = 0.02;
  ball.density_kg_m3 = 2500;
  ball.position_m = place;
  ball.velocity_m_s = first_velocity;
  ASSERT_TRUE(world.spawn(ball));
  ball.position_m = place + Vec3{0.05, 0, 0};
  ball.velocity_m_s = second_velocity;
  ASSERT_TRUE(world.spawn(ball));
}

// The step in which something is heard; the last of ten when nothing is.
StepReport first_heard(World& world) {
  StepReport report;
  for (int step = 0; step < 10 && report.events.empty(); ++step) report = world.step();
  return report;
}

TEST(Limits, AStepReportsStrikesUpToTheLimitAndCountsTheRest) {
  constexpr std::size_t kPairs = kMaxEventsPerStep / 2;
  static_assert(2 * kPairs <= kMaxBodies);
  for (const bool one_more : {false, true}) {
    World world = weightless_world();
    for (std::size_t k = 1; k < kPairs; ++k) {
      spawn_pair(world, {0.2 * static_cast<double>(k % 16), 0.1 * static_cast<double>(k / 16), 1}, {1, 0, 0},
                 {-1, 0, 0});
    }
    // The second of the last two meets the floor besides.
    const Vec3 second = one_more ? Vec3{-1, 0, -1} : Vec3{-1, 0, 0};
    spawn_pair(world, {-1, 0, 0.025}, {1, 0, 0}, second);
    const StepReport report = first_heard(world);
    EXPECT_EQ(report.events.size(), kMaxEventsPerStep);
    EXPECT_EQ(report.dropped_events, one_more ? 1u : 0u);
  }
}

// Each box meets the floor with four corners, and the first one, perhaps, a wall with four more.
TEST(Limits, AStepHoldsContactsUpToTheLimitAndCountsTheRest) {
  constexpr std::size_t kBoxes = kMaxContactsPerStep / 4;
  static_assert(kBoxes <= kMaxBodies);
  for (const bool more : {false, true}) {
    SceneDescription scene = scene_of({});
    StaticDescription wall = scene.statics.front();
    wall.name = "wall";
    wall.normal = {1, 0, 0};
    if (more) scene.statics.push_back(wall);
    World world = world_of(scene, {sounding("bell", 4, box_bank(kSize, 1))});
    BodyDescription box{.name = "box"};
    box.object = "bell";
    box.shape.size_m = kSize;
    for (std::size_t k = 0; k < kBoxes; ++k) {
      box.position_m = {0.055 + 0.2 * static_cast<double>(k % 32), 0.2 * static_cast<double>(k / 32), 0.055};
      box.velocity_m_s = {k == 0 ? -1.0 : 0.0, 0, -1};
      ASSERT_TRUE(world.spawn(box));
    }
    EXPECT_EQ(first_heard(world).dropped_contacts, more ? 1u : 0u);
  }
}

TEST(Limits, ASceneMayNameObjectsUpToTheLimitAndNoMore) {
  SceneDescription scene = scene_of({});
  std::vector<SoundingObject> known;
  for (std::size_t k = 0; k < kMaxObjects; ++k) {
    ObjectDescription object;
    object.name = "o" + std::to_string(k);
    scene.objects.push_back(object);
    known.push_back(sounding(object.name, static_cast<synth::ObjectNumber>(k), box_bank(kSize, 1)));
  }
  const auto full = World::create(scene, known, 48000);
  EXPECT_TRUE(full) << full.error().message;
  scene.objects.push_back(scene.objects.back());
  scene.objects.back().name = "one-more";
  const auto refused = World::create(scene, known, 48000);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(std::to_string(kMaxObjects)), std::string::npos) << refused.error().message;
}

TEST(Limits, ASceneMayHaveStaticsUpToTheLimitAndNoMore) {
  SceneDescription scene = scene_of({});
  while (scene.statics.size() < kMaxStatics) {
    scene.statics.push_back(scene.statics.front());
    scene.statics.back().name = "floor" + std::to_string(scene.statics.size());
  }
  const auto full = World::create(scene, {}, 48000);
  EXPECT_TRUE(full) << full.error().message;
  scene.statics.push_back(scene.statics.front());
  scene.statics.back().name = "one-more";
  EXPECT_FALSE(World::create(scene, {}, 48000));
}

}  // namespace
}  // namespace ringdown::scene
