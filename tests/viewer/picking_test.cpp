// Boxes and spheres in closed form; meshes against the boxes and spheres they are of.
#include "clients/viewer/render/picking.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace ringdown::viewer {
namespace {

void expect_close(glm::vec3 a, glm::vec3 b, float tolerance) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

PickedBody at(glm::vec3 place, std::variant<const DrawnMesh*, BoxShape, SphereShape> shape, std::uint32_t id = 1) {
  return {id, shape, glm::translate(glm::mat4(1), place)};
}

TEST(Picking, ARayHitsASphereOnTheSideThatFacesIt) {
  const std::vector bodies = {at({5, 0, 0}, SphereShape{2}, 7)};
  const auto hit = pick({{0, 0, 1.2F}, {1, 0, 0}}, bodies);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->id, 7u);
  EXPECT_NEAR(hit->distance_m, 5 - 1.6, 1e-5);
  expect_close(hit->point_m, {3.4F, 0, 1.2F}, 1e-5F);
  expect_close(hit->object_point_m, {-1.6F, 0, 1.2F}, 1e-5F);
  expect_close(hit->normal, {-0.8F, 0, 0.6F}, 1e-5F);
  EXPECT_FALSE(pick({{0, 0, 2.001F}, {1, 0, 0}}, bodies));
  EXPECT_FALSE(pick({{0, 0, 0}, {-1, 0, 0}}, bodies));
}

TEST(Picking, ARayHitsABoxOnItsFaceAndFromInside) {
  const std::vector bodies = {at({0, 0, 3}, BoxShape{{2, 4, 6}})};
  const auto hit = pick({{0.5F, -9, 1}, {0, 1, 0}}, bodies);
  ASSERT_TRUE(hit);
  EXPECT_FLOAT_EQ(hit->distance_m, 7);
  expect_close(hit->object_point_m, {0.5F, -2, -2}, 1e-5F);
  expect_close(hit->normal, {0, -1, 0}, 1e-6F);
  const auto inside = pick({{0, 0, 3}, {1, 0, 0}}, bodies);
  ASSERT_TRUE(inside);
  EXPECT_FLOAT_EQ(inside->distance_m, 1);
  expect_close(inside->normal, {-1, 0, 0}, 1e-6F);
  EXPECT_FALSE(pick({{1.01F, -9, 1}, {0, 1, 0}}, bodies));
}

TEST(Picking, ARayHitsTheNearestOfSeveralBodies) {
  const DrawnMesh mesh = box_mesh({1, 1, 1});
  const std::vector bodies = {at({6, 0, 0}, SphereShape{1}, 1), at({3, 0, 0}, &mesh, 2), at({9, 0, 0}, BoxShape{}, 3)};
  EXPECT_EQ(pick({{0, 0, 0}, {1, 0, 0}}, bodies)->id, 2u);
  EXPECT_EQ(pick({{12, 0, 0}, {-1, 0, 0}}, bodies)->id, 3u);
  EXPECT_EQ(pick({{0, 0, 0.9F}, {1, 0, 0}}, bodies)->id, 1u);
}

TEST(Picking, TheHitOfATurnedAndScaledBodyIsInTheObjectsFrame) {
  const DrawnMesh mesh = box_mesh({0.2F, 0.4F, 0.6F});
  PickedBody body = at({1, 2, 3}, &mesh);
  body.pose = glm::rotate(body.pose, 0.7F, glm::normalize(glm::vec3(1, 2, -1)));
  body.size = 2.5F;
  const glm::vec3 struck(0.03F, 0.2F, -0.1F);  // on the face y = 0.2
  const glm::vec3 in_scene(body.pose * glm::vec4(body.size * struck, 1));
  const glm::vec3 outwards = glm::mat3(body.pose) * glm::vec3(0, 1, 0);
  const glm::vec3 way = glm::normalize(-outwards + 0.3F * (glm::mat3(body.pose) * glm::vec3(1, 0, 0)));
  const auto hit = pick({in_scene - 2.0F * way, way}, {&body, 1});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 2, 1e-5);
  expect_close(hit->object_point_m, struck, 1e-5F);
  expect_close(hit->point_m, in_scene, 1e-5F);
  expect_close(hit->normal, outwards, 1e-5F);
}

TEST(Picking, MeshesAreHitWhereTheirSolidsAre) {
  const DrawnMesh box = box_mesh({1, 2, 3}), sphere = sphere_mesh(1);
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  int met = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 from = 5.0F * glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 to = 0.6F * glm::vec3(normal(random), normal(random), normal(random));
    const Ray ray{from, glm::normalize(to - from)};
    const std::vector exact = {at({}, BoxShape{{1, 2, 3}})}, meshed = {at({}, &box)};
    const auto a = pick(ray, exact), b = pick(ray, meshed);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) expect_close(a->point_m, b->point_m, 1e-4F), expect_close(a->normal, b->normal, 1e-4F);
    const std::vector round = {at({}, SphereShape{1})}, facets = {at({}, &sphere)};
    const auto c = pick(ray, round), d = pick(ray, facets);
    if (c && glm::dot(c->normal, ray.direction) < -0.3F) {
      ASSERT_TRUE(d);
      ++met;
      expect_close(c->point_m, d->point_m, 0.03F);  // 48 sides: at most 1 - cos(pi / 48) below the surface, over 0.3
    }
  }
  EXPECT_GT(met, 100);
}

}  // namespace
}  // namespace ringdown::viewer
