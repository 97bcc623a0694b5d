#include "engine/mesh/stuffing.h"

#include "tests/stuffing/dihedral.h"
#include "tests/stuffing/sample_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

namespace ringdown {
namespace {

using namespace test;

struct Sample {
  const char* name;
  Soup surface;
  double size_m;
  double volume = 0;  // 0: nobody knows
};

std::vector<Sample> samples() {
  const double pi = std::numbers::pi;
  const Soup box = box_surface({1, 0.8, 0.6}, 3), sphere = sphere_surface(1);
  return {{"box", box, 0.1, 0.48},
          {"tilted box", moved(box, {0.1, 0.2, 0.3}, some_turn()), 0.09, 0.48},
          {"sphere", sphere, 0.2, 4 * pi / 3},
          {"torus", moved(torus_surface(1, 0.3), {0, 0, 0}, some_turn()), 0.13, 2 * pi * pi * 0.09},
          {"cone", cone_surface(1, 1.5), 0.15, pi / 2},
          {"bowl", bowl_surface(1, 0.12), 0.06, 2 * pi / 3 * (1 - std::pow(0.88, 3))},
          {"plate", moved(box_surface({1, 1, 0.05}), {0, 0, 0}, some_turn()), 0.04, 0.05},
          {"sphere inside out", inside_out(sphere), 0.2, 4 * pi / 3},
          {"sphere with holes", with_holes(sphere, 0.05), 0.17, 4 * pi / 3},
          {"boxes through each other", joined(box, moved(box, {0.3, 0.25, 0.2}, some_turn())), 0.1},
          {"doubled and turned", with_turned(with_doubled(sphere, 0.3), 0.02), 0.17, 4 * pi / 3},
          {"soup of large triangles", random_soup(80, 0.6, 4), 0.1},
          {"soup of small triangles", random_soup(1500, 0.15, 5), 0.08},
          {"open box", with_holes(box, 0.3, 9), 0.06}};
}

class Stuffing : public testing::TestWithParam<Sample> {};

TEST_P(Stuffing, GivesASoundMeshWithinTheAnglesOfThePaper) {
  const auto stuffed = mesh::stuff(GetParam().surface, {.size_m = GetParam().size_m});
  ASSERT_TRUE(stuffed) << stuffed.error().message;
  const Dihedral angles = dihedral(stuffed->mesh);
  EXPECT_GE(angles.least, mesh::kLeastDihedral);
  EXPECT_LE(angles.most, mesh::kMostDihedral);
  const auto checked = mesh::check_mesh(stuffed->mesh, GetParam().name);
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->flipped, 0);
  EXPECT_EQ(checked->duplicates, 0);
  EXPECT_EQ(checked->unused_nodes, 0);
  RecordProperty("elements", static_cast<int>(stuffed->mesh.elements.rows()));
  std::printf("%-26s %7ld elements, %5.2f to %6.2f degrees, volume %+.2f %%, %d crumbs, %d hinges, %d pieces\n",
              GetParam().name, stuffed->mesh.elements.rows(), angles.least, angles.most,
              GetParam().volume > 0 ? 100 * (angles.volume / GetParam().volume - 1) : 0., stuffed->crumbs,
              stuffed->hinges, checked->pieces);
  if (GetParam().volume > 0) {
    EXPECT_NEAR(angles.volume / GetParam().volume, 1, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Stuffing, testing::ValuesIn(samples()), [](const auto& sample) {
  std::string name = sample.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

// Inside and outside by chance, cut anywhere: whatever a surface does to a tetrahedron, it does here.
class Chance final : public mesh::Solid {
 public:
  Chance(unsigned seed, double share) : seed_(seed), share_(share) {
    low.setZero();
    high.setConstant(20);
  }
  [[nodiscard]] bool inside(const Vector3& point) const override { return draw(point) < share_; }
  [[nodiscard]] double leaves(const Vector3& a, const Vector3& b) const override {
    const double at = draw(a + 1.7 * b);  // and often where it just does not move a point, or just does
    if (at < 0.2) return draw(b + 1.3 * a) < 0.5 ? 0.25 : 0.75;
    if (at < 0.4) return draw(b + 1.3 * a) < 0.5 ? 0.4119 : 0.5881;
    return draw(b + 2.1 * a);
  }

 private:
  [[nodiscard]] double draw(const Vector3& point) const {
    std::seed_seq seed{seed_, static_cast<unsigned>(std::lround(point[0] * 1000)),
                       static_cast<unsigned>(std::lround(point[1] * 1000)),
                       static_cast<unsigned>(std::lround(point[2] * 1000))};
    std::mt19937 engine(seed);
    return std::uniform_real_distribution<double>(0, 1)(engine);
  }
  unsigned seed_;
  double share_;
};

TEST(StuffingAnglesHold, WhereverEdgesAreCut) {
  for (const double share : {0.3, 0.5, 0.7, 0.85}) {
    const auto stuffed = mesh::stuff(Chance(7, share), {.size_m = 1});
    ASSERT_TRUE(stuffed) << stuffed.error().message;
    const Dihedral angles = dihedral(stuffed->mesh);
    std::printf("share %.2f: %ld elements, %.3f to %.3f\n", share, stuffed->mesh.elements.rows(), angles.least,
                angles.most);
    EXPECT_GE(angles.least, mesh::kLeastDihedral);
    EXPECT_LE(angles.most, mesh::kMostDihedral);
    const auto checked = mesh::check_mesh(stuffed->mesh, "chance");
    EXPECT_TRUE(checked) << checked.error().message;
  }
}

}  // namespace
}  // namespace ringdown
