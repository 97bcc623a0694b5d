// Closed forms, and the two directions against each other.
#include "clients/viewer/render/camera.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ringdown::viewer {
namespace {

constexpr float kQuarter = glm::half_pi<float>();

void expect_near(glm::vec3 a, glm::vec3 b, float tolerance = 1e-5F) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

TEST(Camera, CameraLooksAtItsTarget) {
  const Camera camera = Camera::from({1, -3, 2}, {4, 1, 2}, kQuarter);
  expect_near(camera.forward(), {0.6F, 0.8F, 0});
  expect_near(camera.right(), {0.8F, -0.6F, 0});
  expect_near(camera.up(), {0, 0, 1});
  EXPECT_FLOAT_EQ(camera.field_of_view, kQuarter);
  EXPECT_FLOAT_EQ(Camera::from({}, {1, 0, 0}, 0).field_of_view, Camera::kDefaultFieldOfView);
  EXPECT_TRUE(std::isfinite(Camera::from({1, 1, 1}, {1, 1, 1}).forward().x));
  EXPECT_FLOAT_EQ(Camera::from({0, 0, 5}, {}).pitch, -Camera::kSteepest);
}

TEST(Camera, RaysThroughThePictureSpanTheFieldOfView) {
  const Camera camera = Camera::from({}, {0, 1, 0}, kQuarter);
  const float diagonal = std::sqrt(0.5F);
  expect_near(camera.ray_through(100, 50, 200, 100).direction, {0, 1, 0});
  expect_near(camera.ray_through(100, 0, 200, 100).direction, {0, diagonal, diagonal});
  expect_near(camera.ray_through(150, 50, 200, 100).direction, {diagonal, diagonal, 0});
}

TEST(Camera, ANarrowPictureShowsEverythingThatAWideOneShows) {
  const Camera wide = Camera::from({0, -3, 1}, {0, 0, 0.5F}, 0.7F);
  Camera narrow = wide;
  narrow.field_of_view = Camera::fitted_field_of_view(wide.field_of_view, 0.8F);
  for (const glm::vec2 corner : {glm::vec2(0, 0), {640, 0}, {0, 400}, {640, 400}}) {
    const Ray ray = wide.ray_through(corner.x, corner.y, 640, 400);
    const auto place = narrow.project(ray.origin + 2.0F * ray.direction, 320, 400);
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->x, corner.x / 2, 0.01);
    EXPECT_GE(place->y, 0);
    EXPECT_LE(place->y, 400);
  }
  EXPECT_EQ(Camera::fitted_field_of_view(0.7F, 2.4F), 0.7F);
}

TEST(Camera, HigherPointsAreHigherAndRightwardPointsFartherRightInThePicture) {
  const Camera camera = Camera::from({}, {0, 1, 0}, kQuarter);
  const auto pixel = camera.project({0.5F, 2, 1}, 200, 100);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 100 + 50 * 0.25, 1e-4);
  EXPECT_NEAR(pixel->y, 50 - 50 * 0.5, 1e-4);
  EXPECT_FALSE(camera.project({0, -1, 0}, 200, 100));
}

TEST(Camera, ProjectingAPointOfARayGivesTheRaysPixel) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = Camera::from({any(random), any(random), any(random)}, {any(random), any(random), any(random)},
                                       1 + 0.5F * any(random));
    const float x = 320 + 320 * any(random), y = 240 + 240 * any(random);
    const Ray ray = camera.ray_through(x, y, 640, 480);
    EXPECT_NEAR(glm::length(ray.direction), 1, 1e-5);
    const auto pixel = camera.project(ray.origin + 3.0F * ray.direction, 640, 480);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, x, 0.01);
    EXPECT_NEAR(pixel->y, y, 0.01);
  }
}

TEST(Camera, CameraMatricesAndProjectAgreeOnThePixel) {
  const Camera camera = Camera::from({1, -2, 1.5F}, {0.2F, 0.1F, 0.3F});
  const Sphere scene{{0, 0, 0.2F}, 1};
  for (const glm::vec3 point : {glm::vec3(0), glm::vec3(0.4F, -0.3F, 0.9F), glm::vec3(-0.7F, 0.2F, 0)}) {
    const glm::vec4 clip = camera.projection(640.0F / 480, scene) * camera.view() * glm::vec4(point, 1);
    const auto pixel = camera.project(point, 640, 480);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(320 + 320 * clip.x / clip.w, pixel->x, 0.01);
    EXPECT_NEAR(240 - 240 * clip.y / clip.w, pixel->y, 0.01);
    EXPECT_LT(std::abs(clip.z), clip.w);
  }
}

TEST(Camera, CameraSeesScenesFromMillimetresToKilometres) {
  for (const float radius : {0.001F, 1.0F, 1000.0F}) {
    const Sphere scene{{2 * radius, 0, 0}, radius};
    const Camera camera = Camera::showing(scene, 1.6F);
    for (const glm::vec3 way : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
      for (const float side : {radius, -radius}) {
        const glm::vec4 clip = camera.projection(1.6F, scene) * camera.view() * glm::vec4(scene.centre + side * way, 1);
        EXPECT_LT(std::abs(clip.x), clip.w);
        EXPECT_LT(std::abs(clip.y), clip.w);
        EXPECT_LT(std::abs(clip.z), clip.w);
      }
    }
  }
}

TEST(Camera, CameraTurnsWithTheMouseAndNeverOverTheTop) {
  Camera camera = Camera::from({}, {0, 1, 0}, kQuarter);
  camera.look(10, 0, 1000);
  EXPECT_NEAR(camera.yaw, kQuarter - 0.02, 1e-6);
  EXPECT_GT(camera.forward().x, 0);
  camera.look(0, 10, 1000);
  EXPECT_NEAR(camera.pitch, -0.02, 1e-6);
  camera.look(0, -1e6F, 1000);
  EXPECT_FLOAT_EQ(camera.pitch, Camera::kSteepest);
  EXPECT_GT(camera.up().z, 0);
  camera.look(1e6F, 0, 1000);
  EXPECT_LE(std::abs(camera.yaw), glm::pi<float>() + 1e-5F);
}

TEST(Camera, ZoomApproachesTheSurfaceAheadAndNeverPassesIt) {
  Camera camera = Camera::from({0, -2, 0}, {});
  camera.zoom(1, 2);
  expect_near(camera.position_m, {0, -2 * Camera::kZoomStep, 0});
  camera.zoom(-1, 2 * Camera::kZoomStep);
  expect_near(camera.position_m, {0, -2, 0});
  camera.zoom(1000, 2);
  expect_near(camera.position_m, {0, -Camera::kMinZoom, 0});
  camera.zoom(5, Camera::kMinZoom / 2);
  expect_near(camera.position_m, {0, -Camera::kMinZoom, 0});
}

// A key that is held down zooms at every frame. The position once became infinite, and the listener's place not a
// number.
TEST(Camera, ZoomGoesAwayAsFarAsAListenerMayBe) {
  Camera camera = Camera::from({0, -2, 0}, {});
  for (int i = 0; i < 5000; ++i) camera.zoom(-1, glm::length(camera.position_m));
  expect_near(camera.position_m, {0, -Camera::kMaxZoom, 0}, 1);
  camera.zoom(-1000, 2);
  EXPECT_TRUE(std::isfinite(camera.position_m.y));
  camera.zoom(1, 2 * Camera::kMaxZoom);
  EXPECT_TRUE(std::isfinite(camera.position_m.y));
}

TEST(Camera, CameraMovesAlongItsOwnAxesAndStraightUp) {
  Camera camera = Camera::from({}, {3, 0, 4});
  camera.move(5, 2, 1);
  expect_near(camera.position_m, {3, -2, 5});
}

}  // namespace
}  // namespace ringdown::viewer
