// Bodies that a file moves: kinematic ones at their velocities, animated ones along their keys. What they touch they
// carry along, and nothing stops them.
#include "engine/scene/gltf/scene.h"
#include "engine/scene/motion_path.h"
#include "engine/scene/rotation.h"
#include "engine/scene/world.h"
#include "tests/scene/gltf_room.h"
#include "tests/scene/gltf_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::scene::gltf_animation_test {
namespace {

using modal::Json;
using test::GltfRoom;
using test::run_until;
using test::silent_world;

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";

Json collider(std::size_t shape, std::size_t material = 0) {
  return {{"geometry", {{"shape", shape}}}, {"physicsMaterial", material}};
}

// A slab, shape 0, and a ball or a box of 0.2 m, shapes 1 and 2. Everything is as rough as can be.
GltfRoom room() {
  GltfRoom made;
  made.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {2, 0.2, 2}}}}});
  made.add("KHR_implicit_shapes", "shapes", {{"type", "sphere"}, {"sphere", {{"radius", 0.1}}}});
  made.add("KHR_implicit_shapes", "shapes", {{"type", "box"}, {"box", {{"size", {0.2, 0.2, 0.2}}}}});
  made.add(kPhysics, "physicsMaterials", {{"staticFriction", 1}, {"dynamicFriction", 1}, {"restitution", 0}});
  return made;
}

std::size_t add_body(GltfRoom& room, std::size_t shape, std::vector<double> place, Json motion) {
  Json node = {{"translation", place}};
  node["extensions"][kPhysics] = {{"collider", collider(shape)}};
  if (!motion.is_null()) node["extensions"][kPhysics]["motion"] = std::move(motion);
  return room.add_node(node);
}

GltfScene read(const GltfRoom& room) {
  const std::string bytes = room.glb();
  auto scene = parse_gltf_scene(std::as_bytes(std::span(bytes)), "room.glb", {});
  EXPECT_TRUE(scene) << scene.error().message;
  return scene.value_or(GltfScene());
}

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

void animate(GltfRoom& room, std::size_t node, const std::string& path, const std::vector<float>& times,
             const std::vector<float>& values, const std::string& way = "LINEAR") {
  const std::size_t width = path == "rotation" ? 4 : 3;
  Json& animations = room.json["animations"];
  if (animations.is_null()) animations = {{{"channels", Json::array()}, {"samplers", Json::array()}}};
  animations[0]["channels"].push_back(
      {{"sampler", animations[0]["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animations[0]["samplers"].push_back({{"input", room.add_array(times, 5126, "SCALAR", 1)},
                                       {"output", room.add_array(values, 5126, width == 4 ? "VEC4" : "VEC3", width)},
                                       {"interpolation", way}});
}

TEST(GltfAnimation, AKinematicBodyKeepsItsVelocityAndNothingStopsIt) {
  GltfRoom made = room();
  add_body(made, 2, {0, 0, 0}, {{"isKinematic", true}, {"linearVelocity", {1, 0, 0}}, {"angularVelocity", {0, 2, 0}}});
  add_body(made, 2, {0.6, 0, 0.02}, {{"mass", 1000}, {"gravityFactor", 0}});
  const GltfScene scene = read(made);
  EXPECT_TRUE(scene.notes.empty());
  World world = silent_world(scene.scene);
  run_until(world, 1.5);
  expect_near(world.bodies()[0].position_m, {1.5, 0, 0}, 1e-6);
  expect_near(rotated(world.bodies()[0].rotation, {1, 0, 0}), {std::cos(3.0), std::sin(3.0), 0}, 1e-6);
  EXPECT_GT(world.bodies()[1].position_m.x, 1.2) << "pushed along";
}

TEST(GltfAnimation, AMovingFloorCarriesWhatLiesOnIt) {
  GltfRoom made = room();
  const std::size_t floor = add_body(made, 0, {0, 0, 0}, nullptr);
  add_body(made, 2, {0, 0.2, 0}, {{"mass", 1}});
  // Twice there and back at 0.5 m/s, in x; the box's friction follows 0.5 m/s at once.
  animate(made, floor, "translation", {0, 1, 2}, {0, 0, 0, 0.5F, 0, 0, 0, 0, 0});
  const GltfScene scene = read(made);
  World world = silent_world(scene.scene);
  run_until(world, 0.9);
  expect_near(world.bodies()[0].position_m, {0.45, 0, 0}, 1e-6);
  EXPECT_NEAR(world.bodies()[1].position_m.x, 0.45, 0.03);
  EXPECT_NEAR(world.bodies()[1].velocity_m_s.x, 0.5, 1e-3);
  run_until(world, 1.8);
  expect_near(world.bodies()[0].position_m, {0.1, 0, 0}, 1e-6);
  EXPECT_NEAR(world.bodies()[1].velocity_m_s.x, -0.5, 1e-3);
  run_until(world, 2.5);  // over and over
  expect_near(world.bodies()[0].position_m, {0.25, 0, 0}, 1e-6);
}

TEST(GltfAnimation, ALiftThrowsWhatItCarriesAsHighAsItsSpeedSays) {
  GltfRoom made = room();
  const std::size_t lift = add_body(made, 0, {0, 0, 0}, nullptr);
  add_body(made, 1, {0, 0.2, 0}, {{"mass", 1}});
  constexpr double kSpeed_m_s = 2;
  animate(made, lift, "translation", {0, 0.5F, 3}, {0, 0, 0, 0, 0.5F * kSpeed_m_s, 0, 0, 0.5F * kSpeed_m_s, 0});
  World world = silent_world(read(made).scene);
  double highest_m = 0;
  while (world.time_s() < 1.2) {
    world.step();
    highest_m = std::max(highest_m, world.bodies()[1].position_m.z);
  }
  EXPECT_NEAR(highest_m, 0.5 * kSpeed_m_s + 0.2 + kSpeed_m_s * kSpeed_m_s / (2 * 9.81), 0.01);
}

TEST(GltfAnimation, PathsFollowTheKeysInEveryWay) {
  const float h = std::sqrt(0.5F);
  GltfRoom made = room();
  Json parent = {{"translation", {0, 1, 0}}, {"children", {1}}};
  made.add_node(parent);
  Json child = {{"translation", {1, 0, 0}}};
  child["extensions"][kPhysics] = {{"collider", collider(2)}};
  made.add_node(child, false);
  animate(made, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, h, 0, h});  // a quarter about the file's y
  animate(made, 1, "translation", {0, 0.5F}, {1, 0, 0, 1, 1, 0}, "STEP");
  const GltfScene scene = read(made);
  ASSERT_EQ(scene.scene.bodies.size(), 1);
  const auto& path = scene.scene.bodies[0].path;
  ASSERT_TRUE(path);
  const auto at = [&](double time_s) { return motion_on(*path, {}, {}, time_s, 1e-3); };
  const double eighth = std::numbers::pi / 8;
  expect_near(at(0.25).position_m, {std::cos(eighth), std::sin(eighth), 1}, 1e-4);
  expect_near(at(0.75).position_m, {std::cos(3 * eighth), std::sin(3 * eighth), 2}, 1e-4);
  expect_near(at(0.25).spin_rad_s, {0, 0, 4 * eighth}, 1e-4);
  expect_near(rotated(at(0.75).rotation, {1, 0, 0}), {std::cos(3 * eighth), std::sin(3 * eighth), 0}, 1e-4);

  // A cubic with these tangents is t^2 from 0 to 1.
  GltfRoom cubic = room();
  const std::size_t node = add_body(cubic, 2, {0, 0, 0}, nullptr);
  animate(cubic, node, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0}, "CUBICSPLINE");
  const auto square = read(cubic).scene.bodies.at(0).path;
  ASSERT_TRUE(square);
  for (const double t : {0.1, 0.4, 0.9}) EXPECT_NEAR(motion_on(*square, {}, {}, t, 1e-3).position_m.x, t * t, 1e-4);
}

TEST(GltfAnimation, BrokenAnimationsAreNamedAndNotPlayed) {
  const auto named = [](const std::vector<float>& times, const std::vector<float>& values) {
    GltfRoom made = room();
    animate(made, add_body(made, 2, {0, 0, 0}, nullptr), "translation", times, values);
    const GltfScene scene = read(made);
    return !scene.scene.bodies.at(0).path && !scene.notes.empty() &&
           scene.notes[0].find("the animated translation of 'node0' is not played") != std::string::npos;
  };
  EXPECT_TRUE(named({0, 1}, {0, 0, 0}));
  EXPECT_TRUE(named({1, 1}, {0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(named({-1, 1}, {0, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(named({0, 1}, {0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace ringdown::scene::gltf_animation_test
