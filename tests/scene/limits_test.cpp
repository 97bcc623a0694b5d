// A scene's capacities: at the limit all is well, one past it is refused or counted.
#include "engine/scene/contact/lasting_events.h"
#include "engine/scene/ode/contact_joints.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace ringdown::scene::limits_test {
namespace {

using test::box_bank;
using test::scene_of;
using test::sounding;
using test::world_of;

constexpr Vec3 kSize{0.1, 0.1, 0.1};

// The step in which something is heard; the last of ten when nothing is.
StepReport first_heard(World& world) {
  StepReport report;
  for (int step = 0; step < 10 && report.events.empty(); ++step) report = world.step();
  return report;
}

TEST(Limits, EventsOfAStepAreKeptUpToTheLimitAndTheRestAreCounted) {
  static_assert(kMaxEventsPerStep >= 4 * kMaxContactsPerStep);
  StepEvents step;
  for (std::size_t k = 0; k < kMaxEventsPerStep; ++k) step.push({});
  EXPECT_EQ(step.dropped, 0u);
  step.push({});
  EXPECT_EQ(step.events.size(), kMaxEventsPerStep);
  EXPECT_EQ(step.dropped, 1u);
}

// As many boxes as fit into a scene land flat at once, each with four strikes and a click, then slide: every contact is
// reported in the same steps. The room for events stays where it was when the scene began.
TEST(Limits, AFullSceneOfBoxesThatLandAndSlideLosesNoEvent) {
  SceneDescription scene = scene_of({});
  scene.statics[0].surface.friction = 0;
  World world = world_of(scene, {sounding("bell", 4, box_bank(kSize, 1))});
  BodyDescription box{.name = "box"};
  box.object = "bell";
  box.shape.size_m = kSize;
  box.surface.restitution = 0;
  for (std::size_t k = 0; k < kMaxBodies; ++k) {
    box.position_m = {0.2 * static_cast<double>(k % 32), 0.2 * static_cast<double>(k / 32), 0.055};
    box.velocity_m_s = {0.3, 0, -1};
    ASSERT_TRUE(world.spawn(box));
  }
  const synth::Event* const room = world.step().events.data();
  std::size_t strikes = 0, clicks = 0, max_contacts = 0;
  while (world.time_s() < 0.1) {
    const StepReport report = world.step();
    EXPECT_EQ(report.events.data(), room);
    EXPECT_EQ(report.dropped_events, 0u);
    strikes += test::only<synth::verb::Strike>(report.events).size();
    clicks += test::only<synth::verb::Click>(report.events).size();
    const auto contacts = test::only<synth::verb::Contact>(report.events).size();
    max_contacts = std::max(max_contacts, static_cast<std::size_t>(contacts));
  }
  EXPECT_EQ(strikes, 4 * kMaxBodies);
  EXPECT_EQ(clicks, kMaxBodies);
  EXPECT_EQ(max_contacts, kMaxBodies);
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
  for (std::size_t k = 0; k < kMaxSceneObjects; ++k) {
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
  EXPECT_NE(refused.error().message.find(std::to_string(kMaxSceneObjects)), std::string::npos)
      << refused.error().message;
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
}  // namespace ringdown::scene::limits_test
