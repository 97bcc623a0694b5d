// Pieces that overlap touch each other only once they have been apart.
#include "engine/scene/fresh_pairs.h"
#include "engine/scene/ode/simulation.h"
#include "tests/scene/box_bank.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace ringdown::scene {
namespace {

// The corners of a box of these edges.
std::vector<double> corners_of(Vec3 size) {
  std::vector<double> corners;
  for (int k = 0; k < 8; ++k) {
    corners.insert(corners.end(),
                   {(k & 1 ? 0.5 : -0.5) * size.x, (k & 2 ? 0.5 : -0.5) * size.y, (k & 4 ? 0.5 : -0.5) * size.z});
  }
  return corners;
}

class RandomPoses {
 public:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Rotation rotation() {
    return normalized(Rotation::from_xyzw(number(-1, 1), number(-1, 1), number(-1, 1), number(0.1, 1)));
  }

 private:
  std::mt19937 random_{3};
};

// Boxes are placed such that they share a point, or such that a plane with this margin parts them.
TEST(FreshPairs, HullsAreApartOnlyIfAPlanePartsThem) {
  RandomPoses random;
  constexpr double kGap_m = 1e-4;
  int found = 0, apart = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::vector<double> one = corners_of({random.number(0.01, 0.1), random.number(0.01, 0.1), 0.003});
    const std::vector<double> two = corners_of({random.number(0.01, 0.1), random.number(0.01, 0.1), 0.003});
    const Matrix3 turn_one = to_matrix(random.rotation()), turn_two = to_matrix(random.rotation());
    const auto inner = [&](const std::vector<double>& box) {
      const Vec3 corner{box[0], box[1], box[2]};
      return Vec3{random.number(-1, 1) * corner.x, random.number(-1, 1) * corner.y, random.number(-1, 1) * corner.z};
    };
    const Vec3 at = random.vector(1);
    PosedHull first{one, turn_one, at - turn_one * inner(one)}, second{two, turn_two, at - turn_two * inner(two)};
    Vec3 direction{0, 0, 1};
    for (int call = 0; call < 20; ++call) ASSERT_FALSE(are_apart(first, second, kGap_m, direction)) << k;

    const Vec3 normal = (1 / length(random.vector(1) + Vec3{2, 0, 0})) * (random.vector(1) + Vec3{2, 0, 0});
    const auto reach = [](const PosedHull& hull, Vec3 along) {
      double best = -1e9;
      for (std::size_t c = 0; c < hull.points_m.size(); c += 3)
        best = std::max(
            best, dot(hull.turn * Vec3{hull.points_m[c], hull.points_m[c + 1], hull.points_m[c + 2]} + hull.position_m,
                      along));
      return best;
    };
    const double overlap_m = reach(first, normal) + reach(second, -1 * normal);
    second.position_m = second.position_m + ((overlap_m + 5 * kGap_m) / dot(normal, normal)) * normal;
    ++apart;
    direction = (1 / length(second.position_m - first.position_m)) * (second.position_m - first.position_m);
    for (int call = 0; call < 20; ++call) {
      if (!are_apart(first, second, kGap_m, direction)) continue;
      ++found;
      break;
    }
  }
  EXPECT_GT(found, 0.95 * apart) << "a search that has not ended goes on in the next step";
}

TEST(FreshPairs, ABodyIsForgottenWithItsPairs) {
  FreshPairs pairs;
  EXPECT_FALSE(pairs.contains(1, 2));
  pairs.add(std::vector<BodyId>{4, 9, 2});
  pairs.add(std::vector<BodyId>{5, 6});
  EXPECT_TRUE(pairs.contains(9, 2) && pairs.contains(2, 9) && pairs.contains(4, 9) && pairs.contains(6, 5));
  EXPECT_FALSE(pairs.contains(2, 5));
  pairs.release([](BodyId a, BodyId b, Vec3&) { return a == 2 && b == 9; });
  EXPECT_FALSE(pairs.contains(9, 2));
  EXPECT_TRUE(pairs.are_siblings(9, 2)) << "for good";
  pairs.forget(4);
  EXPECT_FALSE(pairs.contains(4, 9) || pairs.are_siblings(4, 9));
  EXPECT_TRUE(pairs.contains(5, 6));
}

TEST(FreshPairs, PiecesPassOutOfEachOtherAndThenCollide) {
  SceneDescription scene;
  scene.gravity_m_s2 = {};
  Simulation simulation(scene);
  const modal::Bank bank = test::box_bank({0.1, 0.1, 0.1}, 1);
  const BodyDescription body = test::body_of("a", ShapeType::convex, {});
  const auto solid = make_solid(body, &bank);
  ASSERT_TRUE(solid);
  simulation.put_body(0, *solid, {.position_m = {0, 0, 0}}, {}, false);
  simulation.put_body(1, *solid, {.position_m = {0.06, 0, 0}, .velocity_m_s = {0.5, 0, 0}}, {}, false);
  simulation.keep_from_touching(std::vector<BodyId>{0, 1});
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(simulation.step().empty()) << k;  // 0.05 m on
  simulation.set_motion(1, {.position_m = {0.12, 0, 0}, .velocity_m_s = {-0.5, 0, 0}});
  std::size_t touched = 0;
  for (int k = 0; k < 50; ++k) touched += simulation.step().size();
  EXPECT_GT(touched, 0u);
  EXPECT_GT(simulation.moved()[1].motion.velocity_m_s.x, simulation.moved()[0].motion.velocity_m_s.x);
}

}  // namespace
}  // namespace ringdown::scene
