// What a scene tells those who draw it.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

namespace ringdown::scene::outline_test {
namespace {

void expect_near(Vec3 a, Vec3 b, double tolerance = 1e-12) {
  EXPECT_LE(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(Outline, APlaneStandsAtItsPointNearestToTheOriginAndItsZIsTheNormal) {
  for (const Vec3 normal :
       {Vec3{0, 0, 1}, Vec3{0, 0, -2}, Vec3{3, 0, 4}, Vec3{0, -1, 0}, Vec3{1, 1, 1}, Vec3{1e-9, 0, -1}}) {
    StaticDescription plane;
    plane.normal = normal;
    plane.offset_m = 0.7;
    const StaticOutline outline = outline_of(plane);
    const Vec3 unit = (1 / length(normal)) * normal;
    expect_near(outline.position_m, 0.7 * unit);
    expect_near(to_matrix(outline.rotation) * Vec3{0, 0, 1}, unit);
    EXPECT_NEAR(norm(outline.rotation), 1, 1e-12);
  }
}

TEST(Outline, AStaticBoxesOutlineIsAsDescribed) {
  StaticDescription box;
  box.type = StaticType::box;
  box.size_m = {1, 2, 3};
  box.position_m = {4, 5, 6};
  box.rotation = Rotation::from_xyzw(0, 0, 2, 0);
  const StaticOutline outline = outline_of(box);
  EXPECT_EQ(outline.size_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(outline.position_m, (Vec3{4, 5, 6}));
  EXPECT_EQ(outline.rotation.z, 1);
}

// A bank of 0.2 x 0.1 x 0.06 m, about a point that is not its origin.
TEST(Outline, OutlinesHaveTheSizeOfWhatTheyComeFrom) {
  using test::body_of;
  const Vec3 edges{0.2, 0.1, 0.06};
  auto own_box = body_of("d", ShapeType::box, {3, 0, 1}), own_ball = body_of("e", ShapeType::sphere, {4, 0, 1});
  own_box.shape.size_m = {0.3, 0.2, 0.1};
  own_ball.shape.radius_m = 0.05;
  own_ball.fixed = true;
  own_ball.start_s = 5;
  const auto scene =
      test::scene_of({body_of("a", ShapeType::box, {0, 0, 1}), body_of("b", ShapeType::convex, {1, 0, 1}),
                      body_of("c", ShapeType::trimesh, {2, 0, 1}), own_box, own_ball});
  std::vector<SoundingObject> objects;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    objects.push_back(test::sounding(name, static_cast<synth::ObjectNumber>(objects.size()),
                                     test::box_bank(edges, 2, {0.01, 0.02, 0.03})));
  }
  World world = test::world_of(scene, objects);
  auto told = world.describe();
  ASSERT_EQ(told.size(), 5u);
  for (int i = 0; i < 3; ++i) expect_near(told[i].size_m, edges, 1e-7);
  EXPECT_EQ(told[1].shape, ShapeType::convex);
  EXPECT_EQ(told[1].object, "b");
  EXPECT_EQ(told[3].size_m, (Vec3{0.3, 0.2, 0.1}));
  expect_near(told[4].size_m, {0.1, 0.1, 0.1});
  EXPECT_TRUE(told[4].fixed) << "and it is told before it enters";
  EXPECT_FALSE(told[0].fixed);

  ASSERT_TRUE(world.set_object(test::sounding("b", 1, test::box_bank(2 * edges, 2))));
  world.remove_object(2);
  told = world.describe();
  expect_near(told[1].size_m, 2 * edges, 1e-7);
  EXPECT_EQ(told[2].object, "") << "silent from now on";
}

TEST(Outline, ABankOfAnotherSizeMakesAnotherBody) {
  auto scene = test::scene_of({test::body_of("a", ShapeType::convex, {0, 0, 1})});
  scene.objects[0].material.size = 0.5;
  const World world = test::world_of(scene, {test::sounding("a", 0, test::box_bank({0.2, 0.1, 0.06}, 2))});
  expect_near(world.describe()[0].size_m, {0.1, 0.05, 0.03}, 1e-7);
}

}  // namespace
}  // namespace ringdown::scene::outline_test
