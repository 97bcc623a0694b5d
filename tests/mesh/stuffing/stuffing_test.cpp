#include "engine/mesh/mesh_check.h"
#include "engine/mesh/stuffing/bcc_lattice.h"
#include "engine/mesh/stuffing/stuffing.h"

#include "tests/mesh/stuffing/dihedral.h"
#include "tests/mesh/stuffing/sample_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>
#include <tuple>

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
          {"bowl", bowl_surface(1, 0.12, 64), 0.1, 2 * pi / 3 * (1 - std::pow(0.88, 3))},
          {"plate", moved(box_surface({1, 1, 0.05}), {0, 0, 0}, some_turn()), 0.04, 0.05},
          {"sphere inside out", inside_out(sphere), 0.2, 4 * pi / 3},
          {"sphere with holes", with_holes(sphere, 0.05), 0.17, 4 * pi / 3},
          {"boxes through each other", joined(box, moved(box, {0.3, 0.25, 0.2}, some_turn())), 0.1},
          {"doubled and turned", with_turned(with_doubled(sphere, 0.3), 0.02), 0.17, 4 * pi / 3},
          {"soup of large triangles", random_soup(80, 0.6, 4), 0.16},
          {"soup of small triangles", random_soup(900, 0.15, 5), 0.08},
          {"open box", with_holes(box, 0.3, 9), 0.1}};
}

class StuffingOf : public testing::TestWithParam<Sample> {};

TEST_P(StuffingOf, StuffingGivesASoundMeshWithinTheAngles) {
  const auto stuffed = mesh::stuff(GetParam().surface, {.size_m = GetParam().size_m});
  ASSERT_TRUE(stuffed) << stuffed.error().message;
  const Dihedral angles = dihedral(stuffed->mesh);
  EXPECT_GE(angles.min, mesh::kMinDihedral);
  EXPECT_LE(angles.max, mesh::kMaxDihedral);
  const auto checked = mesh::check_mesh(stuffed->mesh, GetParam().name);
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->flipped, 0);
  EXPECT_EQ(checked->duplicates, 0);
  EXPECT_EQ(checked->unused_nodes, 0);
  RecordProperty("elements", static_cast<int>(stuffed->mesh.elements.rows()));
  std::printf("%-26s %7ld elements, %5.2f to %6.2f degrees, volume %+.2f %%, %d crumbs, %d hinges, %d pieces\n",
              GetParam().name, stuffed->mesh.elements.rows(), angles.min, angles.max,
              GetParam().volume > 0 ? 100 * (angles.volume / GetParam().volume - 1) : 0., stuffed->crumbs,
              stuffed->hinges, checked->pieces);
  if (GetParam().volume > 0) {
    EXPECT_NEAR(angles.volume / GetParam().volume, 1, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, StuffingOf, testing::ValuesIn(samples()), [](const auto& sample) {
  std::string name = sample.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

// Inside and outside by chance, cut anywhere: whatever a surface does to a tetrahedron, it does here.
class Chance final : public mesh::Solid {
 public:
  Chance(unsigned seed, double share) : seed_(seed), share_(share) {
    low.setZero();
    high.setConstant(14);
  }
  [[nodiscard]] bool inside(const Vector3& point) const override { return draw(point) < share_; }
  [[nodiscard]] double exit_fraction(const Vector3& a, const Vector3& b) const override {
    const double kind = draw(a + 1.7 * b), near = (a - b).norm() > 0.9 ? mesh::kNearLong : mesh::kNearShort;
    const bool at_a = draw(b + 1.3 * a) < 0.5;  // often where it just moves a point, or just does not
    if (kind < 0.35) return at_a ? near - 1e-6 : 1 - near + 1e-6;
    if (kind < 0.5) return at_a ? near + 1e-6 : 1 - near - 1e-6;
    return draw(b + 2.1 * a);
  }

 private:
  [[nodiscard]] double draw(const Vector3& point) const {
    std::uint64_t bits = seed_;
    for (int k = 0; k < 3; ++k) {
      bits += static_cast<std::uint64_t>(std::lround(point[k] * 1000)) + 0x9E3779B97F4A7C15;
      bits = (bits ^ bits >> 30) * 0xBF58476D1CE4E5B9;
      bits = (bits ^ bits >> 27) * 0x94D049BB133111EB;
      bits ^= bits >> 31;
    }
    return static_cast<double>(bits >> 11) / 9007199254740992.0;
  }

  unsigned seed_;
  double share_;
};

TEST(StuffingAnglesHold, AnglesHoldWhereverEdgesAreCut) {
  for (const double share : {0.5, 0.8}) {
    const auto stuffed = mesh::stuff(Chance(7, share), {.size_m = 1});
    ASSERT_TRUE(stuffed) << stuffed.error().message;
    const Dihedral angles = dihedral(stuffed->mesh);
    std::printf("share %.2f: %ld elements, %.3f to %.3f\n", share, stuffed->mesh.elements.rows(), angles.min,
                angles.max);
    EXPECT_GE(angles.min, mesh::kMinDihedral);
    EXPECT_LE(angles.max, mesh::kMaxDihedral);
    const auto checked = mesh::check_mesh(stuffed->mesh, "chance");
    EXPECT_TRUE(checked) << checked.error().message;
  }
}

TEST(Stuffing, StuffingIsTheSameForAnyNumberOfThreads) {
  const Soup soup = with_holes(bowl_surface(1, 0.2, 40), 0.05);
  const auto one = mesh::stuff(soup, {.size_m = 0.1, .threads = 1}),
             five = mesh::stuff(soup, {.size_m = 0.1, .threads = 5});
  ASSERT_TRUE(one && five);
  EXPECT_EQ(one->mesh.nodes, five->mesh.nodes);
  EXPECT_EQ(one->mesh.elements, five->mesh.elements);
}

TEST(Stuffing, StuffingPutsTheNodesOfItsSkinOnTheSurface) {
  const auto stuffed = mesh::stuff(sphere_surface(1, 200), {.size_m = 0.25});
  ASSERT_TRUE(stuffed);
  std::map<std::array<int, 3>, int> faces;
  for (Eigen::Index e = 0; e < stuffed->mesh.elements.rows(); ++e) {
    for (const auto& corners : mesh::kTetFaces) {
      std::array<int, 3> face;
      for (int k = 0; k < 3; ++k) face[k] = stuffed->mesh.elements(e, corners[k]);
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  }
  for (const auto& [face, count] : faces) {
    for (const int node : face) {
      if (count == 1) {
        ASSERT_NEAR(stuffed->mesh.nodes.row(node).norm(), 1, 5e-4);
      }
    }
  }
}

TEST(Stuffing, ASurfaceThatCannotBeStuffedIsRefusedWithAReason) {
  const Soup box = box_surface({1, 1, 1});
  const std::tuple<Soup, double, const char*> cases[] = {
      {box, 0, "a mesh size above zero"},
      {box, 0.001, "million points, above 30 million"},
      {Soup{}, 0.1, "has no triangles"},
      {patch(1, 1, [](double s, double t) { return Vector3(s, t, 0); }), 0.1, "finds nothing inside the surface"}};
  for (const auto& [soup, size_m, sentence] : cases) {
    const auto stuffed = mesh::stuff(soup, {.size_m = size_m});
    ASSERT_FALSE(stuffed) << sentence;
    EXPECT_NE(stuffed.error().message.find(sentence), std::string::npos) << stuffed.error().message;
  }
  const auto stopped = mesh::stuff(box, {.size_m = 0.05}, [](std::string_view, double) { return false; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::cancelled);
}

TEST(Stuffing, StuffingNamesTheFinestSizeThatFits) {
  const Soup box = box_surface({1, 1, 1});
  const auto refused = mesh::stuff(box, {.size_m = 0.001});
  ASSERT_FALSE(refused);
  const std::string sentence = refused.error().message;
  const double finest_m = std::stod(sentence.substr(sentence.rfind(';') + 1)) / 1000;
  EXPECT_GT(finest_m, 0.003);
  EXPECT_LT(finest_m, 0.006);
}

}  // namespace
}  // namespace ringdown
