#include "engine/mesh/surface/surface_repair.h"

#include "engine/mesh/files/surface_file.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown {
namespace {

using mesh::Fault;

mesh::TriangleMesh brick() { return test::box({0, 0, 0}, {0.3, 0.2, 0.1}); }
mesh::TriangleMesh ball() { return test::sphere(0.05, 24); }

struct Case {
  const char* what;
  mesh::TriangleMesh damaged;
  double volume_m3, tolerance;
};

TEST(SurfaceRepair, TheRepairMakesSoundWhatCanBeMended) {
  const double ball_m3 = mesh::diagnose(ball()).volume_m3;
  const Case cases[] = {
      {"flat holes", test::without(brick(), {0, 5}), 0.006, 1e-12},
      {"a small hole", test::without(ball(), {100, 101, 102}), ball_m3, 0.01},
      {"flipped", test::with_flipped(ball(), 7), ball_m3, 1e-12},
      {"inside out", test::inside_out(brick()), 0.006, 1e-12},
      {"duplicates", test::with_copies(ball(), 4), ball_m3, 1e-12},
      {"a fin", test::with_fin(brick(), {0.1, 0.1, -0.2}), 0.006, 1e-12},
      {"a side split on one side only", test::with_split_side(brick(), 3), 0.006, 1e-12},
      {"all of it", test::with_copies(test::with_flipped(test::without(ball(), {100, 150, 200}), 9), 11), ball_m3,
       0.01},
      {"a body inside another", test::united(brick(), test::box({0.1, 0.1, 0.02}, {0.2, 0.15, 0.08})), 0.006, 1e-12},
      {"two that cut each other", test::united(brick(), test::moved(brick(), {0.1, 0.07, 0.03})),
       0.012 - 0.2 * 0.13 * 0.07, 1e-9},
      {"a loose scrap",
       test::united(brick(),
                    test::without(test::box({1, 0, 0}, {1.02, 0.02, 0.02}), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10})),
       0.006, 1e-12},
  };
  for (const auto& [what, damaged, volume_m3, tolerance] : cases) {
    const mesh::PreparedSurface prepared = mesh::prepare(mesh::weld(damaged, 1e-7));
    EXPECT_FALSE(prepared.found.sound()) << what;
    EXPECT_FALSE(prepared.actions.empty()) << what;
    for (const auto& finding : prepared.left.findings) {
      EXPECT_TRUE(mesh::is_harmless(finding.fault)) << what << ": " << mesh::describe(finding);
    }
    EXPECT_NEAR(prepared.left.volume_m3 / volume_m3, 1, tolerance) << what;
  }
}

TEST(SurfaceRepair, TheRepairLeavesASoundSurfaceAsItIs) {
  const auto prepared = mesh::prepare(ball());
  EXPECT_TRUE(prepared.actions.empty());
  EXPECT_TRUE(prepared.mesh.nodes == ball().nodes);
  EXPECT_TRUE(prepared.mesh.triangles == ball().triangles);
}

TEST(SurfaceRepair, TheRepairCountsWhatItDid) {
  const auto actions = mesh::repair(test::with_copies(test::without(brick(), {0, 5}), 5)).actions;
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_EQ(actions[0], "dropped 2 duplicated triangles");
  EXPECT_EQ(actions[1], "closed 2 holes");
}

// A hole as wide as the ball would be closed by a guess.
TEST(SurfaceRepair, TheRepairLeavesLargeHoles) {
  std::vector<int> cap;
  for (int t = 0; t < 24 * 9; ++t) cap.push_back(t);
  auto bent = test::without(ball(), cap);
  for (Eigen::Index n = 0; n < bent.nodes.rows(); n += 2) bent.nodes(n, 2) *= 1.1;
  EXPECT_TRUE(mesh::prepare(mesh::weld(bent, 1e-9)).left.find(Fault::kHole));
}

// A square tube of n rings along x with closed ends, and inside it a wall from edge to edge that is open at both ends:
// its triangles become fins one after the other.
mesh::TriangleMesh tube_with_wall(int rings) {
  const auto node = [](int ring, int corner) { return 4 * ring + corner % 4; };
  mesh::TriangleMesh tube;
  tube.nodes.resize(4 * rings, 3);
  std::vector<std::array<int, 3>> triangles = {{node(0, 0), node(0, 3), node(0, 1)},
                                               {node(0, 3), node(0, 2), node(0, 1)}};
  for (int ring = 0; ring < rings; ++ring) {
    tube.nodes.middleRows<4>(4 * ring) << ring, 0, 0, ring, 1, 0, ring, 1, 1, ring, 0, 1;
    if (ring + 1 == rings) break;
    for (int k = 0; k < 4; ++k) {
      triangles.push_back({node(ring, k), node(ring, k + 1), node(ring + 1, k)});
      triangles.push_back({node(ring, k + 1), node(ring + 1, k + 1), node(ring + 1, k)});
    }
    triangles.push_back({node(ring, 0), node(ring, 2), node(ring + 1, 0)});
    triangles.push_back({node(ring, 2), node(ring + 1, 2), node(ring + 1, 0)});
  }
  const int last = rings - 1;
  triangles.push_back({node(last, 0), node(last, 1), node(last, 3)});
  triangles.push_back({node(last, 3), node(last, 1), node(last, 2)});
  tube.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (Eigen::Index t = 0; t < tube.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i)
      tube.triangles(t, i) = triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(i)];
  }
  return tube;
}

mesh::TriangleMesh with_split_sides(mesh::TriangleMesh mesh) {
  const auto count = static_cast<int>(mesh.triangles.rows());
  for (int t = 0; t < count; t += 4) mesh = test::with_split_side(mesh, t);
  return mesh;
}

mesh::TriangleMesh without_if(const mesh::TriangleMesh& mesh, const std::function<bool(int)>& unwanted) {
  std::vector<int> gone;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    if (unwanted(t)) gone.push_back(t);
  }
  return test::without(mesh, gone);
}

mesh::TriangleMesh cylinder_without_ends(int segments) {
  const mesh::TriangleMesh whole = test::cylinder(1, 1, segments);
  return without_if(whole, [&whole](int t) {
    const auto height = [&](int i) { return whole.nodes(whole.triangles(t, i), 2); };
    return height(0) == height(1) && height(1) == height(2);
  });
}

// A cone whose sides are missing in turn, so that all holes meet at its tip.
mesh::TriangleMesh cone_of_holes(int segments) {
  const mesh::TriangleMesh cone = test::lathe({{0, 0}, {1, 0}, {0, 1}}, segments);
  return without_if(cone, [&cone, side = 0](int t) mutable {
    bool at_tip = false;
    for (int i = 0; i < 3; ++i) at_tip = at_tip || cone.nodes(cone.triangles(t, i), 2) == 1;
    return at_tip && side++ % 2 == 0;
  });
}

TEST(SurfaceRepair, AWallInsideATubeGoesTriangleByTriangle) {
  const mesh::RepairedSurface repaired = mesh::repair(tube_with_wall(20));
  EXPECT_EQ(repaired.actions, std::vector<std::string>{"dropped 38 fins"});
  EXPECT_TRUE(mesh::diagnose(repaired.mesh).sound());
}

// The number of triangles, edges and nodes that a repair visits grows as fast as the surface, also where one repair
// makes the next one necessary, where holes are long, and where many of them meet.
TEST(SurfaceRepair, TheRepairVisitsTwiceAsMuchOfASurfaceTwiceAsLarge) {
  const std::pair<const char*, std::function<mesh::TriangleMesh(int)>> families[] = {
      {"fins behind fins", [](int n) { return tube_with_wall(4 * n); }},
      {"flat triangles", [](int n) { return with_split_sides(test::cylinder(1, 1, n)); }},
      {"two long holes", cylinder_without_ends},
      {"many holes", [](int n) { return without_if(tube_with_wall(n), [](int t) { return t % 9 == 0; }); }},
      {"holes around one point", cone_of_holes},
      {"copies", [](int n) { return test::with_copies(test::cylinder(1, 1, n), 3); }},
  };
  constexpr int kRows = 60;
  for (const auto& [what, family] : families) {
    const mesh::TriangleMesh small = family(kRows), large = family(2 * kRows);
    const double growth = static_cast<double>(large.triangles.rows()) / static_cast<double>(small.triangles.rows());
    const double steps =
        static_cast<double>(mesh::repair(large).steps) / static_cast<double>(mesh::repair(small).steps);
    EXPECT_LT(steps, 1.1 * growth) << what;
    EXPECT_GT(steps, 0.8 * growth) << what << ": not everything was counted";
  }
}

}  // namespace
}  // namespace ringdown
