// Long bodies that turn or fly fast, against thin walls, rims and pins: what should meet must meet. All flights are
// without gravity and about a principal axis, so until the first contact they have a closed form.
#include "engine/scene/rotation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene::tips_test {
namespace {

using test::box_bank;
using test::sounding;

constexpr double kWall_m = 0.002, kDensity_kg_m3 = 7800;

struct Shot {
  Vec3 size_m;  // the body's, its longest edge first
  ShapeType shape = ShapeType::box;
  Vec3 axis;  // of the spin: y or z, both of them along the wall
  double turned_rad = 0, spin_rad_s = 0;
  Vec3 position_m, velocity_m_s;
};

// The corners of a box that has been turned about `axis` by `angle_rad`, by Rodrigues' formula.
std::array<Vec3, 8> corners(Vec3 size_m, Vec3 axis, double angle_rad, Vec3 position_m) {
  std::array<Vec3, 8> all;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  for (int k = 0; k < 8; ++k) {
    const Vec3 p{(k & 1 ? 0.5 : -0.5) * size_m.x, (k & 2 ? 0.5 : -0.5) * size_m.y, (k & 4 ? 0.5 : -0.5) * size_m.z};
    all[k] = position_m + c * p + s * cross(axis, p) + (1 - c) * dot(axis, p) * axis;
  }
  return all;
}

double farthest_x(const std::array<Vec3, 8>& points) { return std::ranges::max_element(points, {}, &Vec3::x)->x; }

// When the body would reach the plane x = `at_m` if nothing stopped it; infinite if not within a second.
double time_of_touch(const Shot& shot, double at_m) {
  const auto reach = [&](double t) {
    return farthest_x(corners(shot.size_m, shot.axis, shot.turned_rad + shot.spin_rad_s * t,
                              shot.position_m + t * shot.velocity_m_s));
  };
  const double dt = 0.002 / (1 + std::abs(shot.spin_rad_s) + 10 * length(shot.velocity_m_s));
  for (double t = 0; t < 1; t += dt) {
    if (reach(t) >= at_m) return t;
  }
  return INFINITY;
}

BodyDescription thrown(const Shot& shot) {
  BodyDescription body = test::body_of("thrown", shot.shape, shot.position_m);
  body.rotation = about(shot.axis, shot.turned_rad);
  body.spin_rad_s = shot.spin_rad_s * shot.axis;
  body.velocity_m_s = shot.velocity_m_s;
  return body;
}

World world_with(const Shot& shot, SceneDescription scene, double step_s) {
  scene.gravity_m_s2 = {};
  scene.step_s = step_s;
  const Vec3 s = shot.size_m;
  return test::world_of(scene, {sounding("thrown", 0, box_bank(s, kDensity_kg_m3 * s.x * s.y * s.z))});
}

BodyDescription obstacle(Vec3 size_m, Vec3 position_m, bool fixed) {
  BodyDescription body;
  body.name = "obstacle";
  body.shape = {ShapeType::box, size_m, 0};
  body.density_kg_m3 = kDensity_kg_m3;
  body.position_m = position_m;
  body.fixed = fixed;
  return body;
}

enum class Wall { of_the_scene, fixed_body, free_body };

World before_a_wall(const Shot& shot, Wall wall, double step_s) {
  const Vec3 size_m{kWall_m, 3, 3};
  SceneDescription scene = test::scene_of({thrown(shot)}, 0.5);
  scene.statics.clear();
  if (wall == Wall::of_the_scene) {
    StaticDescription box;
    box.name = "wall";
    box.type = StaticType::box;
    box.size_m = size_m;
    scene.statics = {box};
  } else {
    scene.bodies.push_back(obstacle(size_m, {}, wall == Wall::fixed_body));
  }
  return world_with(shot, scene, step_s);
}

bool deviates(const BodyState& body, const Shot& shot) {
  return length(body.spin_rad_s - shot.spin_rad_s * shot.axis) > 0.01 * std::abs(shot.spin_rad_s) ||
         length(body.velocity_m_s - shot.velocity_m_s) > 0.01 * length(shot.velocity_m_s) + 1e-6;
}

// How far the thrown body's foremost corner is beyond the wall's middle.
double beyond(const World& world, Vec3 size_m) {
  const auto states = world.bodies();
  const Matrix3 turn = to_matrix(states[0].rotation);
  double max_m = -INFINITY;
  for (const Vec3& corner : corners(size_m, {1, 0, 0}, 0, {})) {
    Vec3 place = states[0].position_m + turn * corner;
    if (states.size() > 1) place = transpose(to_matrix(states[1].rotation)) * (place - states[1].position_m);
    max_m = std::max(max_m, place.x);
  }
  return max_m;
}

// Empty when the body was stopped by the wall at the right time, and no corner got past the middle of the wall until
// it had turned twice more; else what went wrong.
std::string fault_of(const Shot& shot, Wall wall, double step_s) {
  World world = before_a_wall(shot, wall, step_s);
  const double touch_s = time_of_touch(shot, -kWall_m / 2), end_s = touch_s + 4 * M_PI / shot.spin_rad_s;
  bool struck = false;
  while (world.time_s() < end_s) {
    world.step();
    struck |= deviates(world.bodies()[0], shot);
    if (!struck && world.time_s() > touch_s + step_s) return "missed the wall";
    if (const double m = beyond(world, shot.size_m); m > 0) return "got past the wall's middle by " + std::to_string(m);
  }
  return struck ? "" : "never met the wall";
}

constexpr std::pair<const char*, Vec3> kBodies[] = {
    {"rod", {0.3, 0.006, 0.006}}, {"knife", {0.2, 0.02, 0.001}}, {"plate", {0.2, 0.15, 0.002}}};
constexpr ShapeType kShapes[] = {ShapeType::box, ShapeType::convex, ShapeType::trimesh};

TEST(Tips, OfSpinningBodiesDoNotPassWalls) {
  struct Way {
    Wall wall;
    double distance;  // from the wall at the start: 0 for the body's flat side to touch it, 1 for a corner only
    Vec3 velocity_m_s;
  };
  constexpr Way ways[] = {{Wall::of_the_scene, 0.9, {}},
                          {Wall::fixed_body, 0.5, {}},
                          {Wall::free_body, 0.75, {}},
                          {Wall::of_the_scene, 0.8, {0, 2, 3}},
                          {Wall::fixed_body, 1.5, {6, 1, 0}}};
  int shots = 0, stopped = 0;
  for (const auto& [name, size_m] : kBodies) {
    for (const ShapeType shape : kShapes) {
      for (const Vec3 axis : {Vec3{0, 1, 0}, {0, 0, 1}}) {
        for (const double spin_rad_s : {20.0, 60.0, 150.0, 400.0, 1000.0}) {
          for (const Way& way : ways) {
            const double flat_m = 0.5 * (axis.y > 0 ? size_m.z : size_m.y);
            const double corner_m = std::hypot(0.5 * size_m.x, flat_m);
            const double middle_m = -kWall_m / 2 - flat_m - way.distance * (corner_m - flat_m);
            const Shot shot{size_m,           shape,           axis, M_PI / 2 + 0.1 * shots, spin_rad_s,
                            {middle_m, 0, 0}, way.velocity_m_s};
            Shot clear = shot;  // turned to where it does not touch yet
            while (time_of_touch(clear, -kWall_m / 2) == 0) clear.turned_rad += 0.3;
            const std::string fault = fault_of(clear, way.wall, 0.002);
            ++shots;
            stopped += fault.empty();
            EXPECT_EQ(fault, "") << name << ", shape " << static_cast<int>(shape) << ", axis "
                                 << (axis.y > 0 ? "y" : "z") << ", " << spin_rad_s << " rad/s, wall "
                                 << static_cast<int>(way.wall) << ", " << way.velocity_m_s.x << " m/s towards it";
          }
        }
      }
    }
  }
  EXPECT_EQ(shots, 450);
  EXPECT_EQ(stopped, shots);
}

TEST(Tips, OfABodyThatTurnsJustClearOfAWallMissIt) {
  for (const ShapeType shape : kShapes) {
    for (const double spin_rad_s : {60.0, 400.0, 1000.0}) {
      const Vec3 size_m = kBodies[0].second;
      const double reach_m = 0.5 * std::hypot(size_m.x, size_m.y);
      const Shot shot{size_m, shape, {0, 0, 1}, 1, spin_rad_s, {-reach_m - kWall_m / 2 - 0.0003, 0, 0}, {}};
      World world = before_a_wall(shot, Wall::of_the_scene, 0.002);
      while (world.time_s() < 0.3) world.step();
      EXPECT_FALSE(deviates(world.bodies()[0], shot)) << spin_rad_s;
    }
  }
}

// A pin stands in the plane in which a rod turns, parallel to its axis, at 0.3 of the rod's length from the middle: the
// rod meets the pin with its side, not with a corner.
TEST(Tips, ASpinningRodMeetsAPinWithItsSide) {
  for (const ShapeType shape : kShapes) {
    for (const double spin_rad_s : {40.0, 150.0, 400.0, 1000.0}) {
      const Vec3 size_m = kBodies[0].second;
      const Shot shot{size_m, shape, {0, 0, 1}, 0.3, spin_rad_s, {}, {}};
      const double arm_m = 0.3 * size_m.x, pin_m = 0.004;
      SceneDescription scene = test::scene_of({thrown(shot), obstacle({pin_m, pin_m, 0.2}, {0, arm_m, 0}, true)}, 0.5);
      scene.statics.clear();
      World world = world_with(shot, scene, 0.002);
      // The rod's leading side reaches the pin's nearest edge before its middle line reaches the pin's middle.
      const double latest_s = (M_PI / 2 - shot.turned_rad) / spin_rad_s;
      while (world.time_s() < latest_s + 0.002) world.step();
      EXPECT_TRUE(deviates(world.bodies()[0], shot)) << static_cast<int>(shape) << ", " << spin_rad_s << " rad/s";
    }
  }
}

// A rod flies broadside past the rim of a wall, which overlaps a part of the rod's one half.
TEST(Tips, OfAFlyingRodMeetTheRimOfAWall) {
  for (const ShapeType shape : kShapes) {
    for (const double speed_m_s : {5.0, 50.0, 300.0}) {
      for (const double overlap : {0.1, 0.4, -0.01}) {
        const Vec3 size_m = kBodies[0].second;
        const Shot shot{size_m, shape, {0, 0, 1}, M_PI / 2, 0, {-0.5013, 0, 0}, {speed_m_s, 0, 0}};
        const double rim_m = (0.5 - overlap) * size_m.x, height_m = 0.4;
        SceneDescription scene = test::scene_of(
            {thrown(shot), obstacle({kWall_m, height_m, height_m}, {0, rim_m + height_m / 2, 0}, true)}, 0.5);
        scene.statics.clear();
        World world = world_with(shot, scene, 0.002);
        while (world.time_s() < 0.5013 / speed_m_s + 0.002) world.step();
        EXPECT_EQ(deviates(world.bodies()[0], shot), overlap > 0)
            << static_cast<int>(shape) << ", " << speed_m_s << " m/s, " << overlap << " of its length";
      }
    }
  }
}

}  // namespace
}  // namespace ringdown::scene::tips_test
