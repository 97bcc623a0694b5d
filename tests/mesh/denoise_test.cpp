#include "engine/mesh/surface/denoise.h"

#include "engine/mesh/surface/surface_check.h"
#include "tests/mesh/sample_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ringdown {
namespace {

constexpr double kRadius = 0.06, kSection = 0.02, kNoise = 0.0006;

mesh::TriangleMesh scanned_ring() {
  mesh::TriangleMesh ring = test::torus(kRadius, kSection, 64);
  std::mt19937 random(1);
  std::normal_distribution<double> deviate(0, kNoise);
  for (double& x : ring.nodes.reshaped()) x += deviate(random);
  return ring;
}

// The root mean square of the nodes' distances from the ring without noise.
double roughness(const mesh::TriangleMesh& ring) {
  double sum = 0;
  for (const auto& at : ring.nodes.rowwise()) {
    const double off = std::hypot(std::hypot(at[0], at[1]) - kRadius, at[2]) - kSection;
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(ring.nodes.rows()));
}

TEST(Denoise, AScanThatNoiseHasFoldedUnfoldsAndKeepsItsVolume) {
  const mesh::TriangleMesh scan = scanned_ring();
  const auto cuts = [](const mesh::TriangleMesh& surface) { return mesh::self_intersections(surface, 100'000).size(); };
  ASSERT_GT(cuts(scan), 50u);
  EXPECT_TRUE(mesh::is_folded_by_noise(scan));
  const mesh::Denoised smooth = mesh::denoise(scan, mesh::FirstAverage::kOfAll);
  EXPECT_LT(cuts(smooth.mesh), cuts(scan) / 10);
  EXPECT_LT(roughness(smooth.mesh), 0.5 * roughness(scan));
  EXPECT_NEAR(mesh::diagnose(smooth.mesh).volume_m3 / mesh::diagnose(scan).volume_m3, 1, 1e-3);
  EXPECT_GT(smooth.moved_m, 0.5 * kNoise);
}

// Nodes of a box's edges lie inside the box where its edges became round. Its volume is given back to its faces, which
// puts the others a little outside.
TEST(Denoise, EdgesStaySharpWhereOnlyWhatIsFoldedIsAveragedFirst) {
  constexpr double kSide = 0.06, kRough = 0.0004;
  mesh::TriangleMesh box = test::box({0, 0, 0}, {kSide, kSide, kSide});
  for (int times = 0; times < 4; ++times) box = test::subdivided(box);
  const mesh::TriangleMesh clean = box;
  std::mt19937 random(1);
  std::normal_distribution<double> deviate(0, kRough);
  for (double& x : box.nodes.reshaped()) x += deviate(random);
  const auto depth_of_edges = [&](mesh::FirstAverage first) {
    const mesh::TriangleMesh smooth = mesh::denoise(box, first).mesh;
    double sum = 0;
    int count = 0;
    for (Eigen::Index n = 0; n < clean.nodes.rows(); ++n) {
      const Eigen::Array3d at = clean.nodes.row(n).transpose().array();
      if ((at * (kSide - at) < 1e-12).count() != 2) continue;
      for (int axis = 0; axis < 3; ++axis) {
        if (at[axis] * (kSide - at[axis]) >= 1e-12) continue;
        sum += (at[axis] > 0 ? 1 : -1) * (at[axis] - smooth.nodes(n, axis));
        ++count;
      }
    }
    return sum / count;
  };
  const double sharp = depth_of_edges(mesh::FirstAverage::kOfFolded),
               round = depth_of_edges(mesh::FirstAverage::kOfAll);
  EXPECT_LT(std::abs(sharp), 0.25 * kRough);
  EXPECT_GT(round, 2 * std::abs(sharp));
}

TEST(Denoise, BodiesThatRunIntoEachOtherAreNotFoldedByNoise) {
  const mesh::TriangleMesh ring = test::torus(kRadius, kSection, 64);
  EXPECT_FALSE(mesh::is_folded_by_noise(test::united(ring, test::moved(ring, {0.03, 0.001, 0.0005}))));
  EXPECT_FALSE(mesh::is_folded_by_noise(ring));
}

}  // namespace
}  // namespace ringdown
