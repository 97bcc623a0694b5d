#include "engine/mesh/surface_repair.h"

#include "engine/mesh/surface_reader.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

using mesh::Fault;

mesh::TriangleMesh block() { return test::box({0, 0, 0}, {0.3, 0.2, 0.1}); }
mesh::TriangleMesh ball() { return test::sphere(0.05, 24); }

struct Case {
  const char* what;
  mesh::TriangleMesh damaged;
  double volume_m3, tolerance;
};

TEST(Repair, MakesSoundWhatCanBeMended) {
  const double ball_m3 = mesh::diagnose(ball()).volume_m3;
  const Case cases[] = {
      {"flat holes", test::without(block(), {0, 5}), 0.006, 1e-12},
      {"a small hole", test::without(ball(), {100, 101, 102}), ball_m3, 0.01},
      {"flipped", test::with_flipped(ball(), 7), ball_m3, 1e-12},
      {"inside out", test::inside_out(block()), 0.006, 1e-12},
      {"duplicates", test::with_copies(ball(), 4), ball_m3, 1e-12},
      {"a fin", test::with_fin(block(), {0.1, 0.1, -0.2}), 0.006, 1e-12},
      {"a side split on one side only", test::with_split_side(block(), 3), 0.006, 1e-12},
      {"all of it", test::with_copies(test::with_flipped(test::without(ball(), {100, 150, 200}), 9), 11), ball_m3,
       0.01},
      {"a cavity turned outward", test::united(block(), test::box({0.1, 0.1, 0.02}, {0.2, 0.15, 0.08})), 0.0057, 1e-9},
      {"a loose scrap",
       test::united(block(),
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

TEST(Repair, LeavesASoundSurfaceAsItIs) {
  const auto prepared = mesh::prepare(ball());
  EXPECT_TRUE(prepared.actions.empty());
  EXPECT_TRUE(prepared.mesh.nodes == ball().nodes);
  EXPECT_TRUE(prepared.mesh.triangles == ball().triangles);
}

TEST(Repair, CountsWhatItDid) {
  const auto actions = mesh::repair(test::with_copies(test::without(block(), {0, 5}), 5)).actions;
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_EQ(actions[0], "dropped 2 duplicated triangles");
  EXPECT_EQ(actions[1], "closed 2 holes");
}

// A hole as wide as the ball would be closed by a guess.
TEST(Repair, LeavesLargeHolesAndCuts) {
  std::vector<int> cap;
  for (int t = 0; t < 24 * 9; ++t) cap.push_back(t);
  auto bent = test::without(ball(), cap);
  for (Eigen::Index n = 0; n < bent.nodes.rows(); n += 2) bent.nodes(n, 2) *= 1.1;
  EXPECT_TRUE(mesh::prepare(mesh::weld(bent, 1e-9)).left.find(Fault::kHole));
  const auto crossed = test::united(block(), test::moved(block(), {0.1, 0.07, 0.03}));
  EXPECT_TRUE(mesh::prepare(crossed).left.find(Fault::kOverlap));
}

}  // namespace
}  // namespace ringdown
