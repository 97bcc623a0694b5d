// The error that a bank states against the true one, where the mesh's skin is not the body's surface.
#include "engine/bake/bake.h"
#include "engine/mesh/stuffing/stuffed_body.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/mesh/sample_surfaces.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace ringdown {
namespace {

const modal::Material kSteel{
    .name = "steel", .youngs_modulus_pa = 200e9, .poisson_ratio = 0.3, .density_kg_m3 = 7850, .damping = {}};

// A box that stands askew in any lattice.
mesh::TriangleMesh askew_box(const test::Vec& size) {
  mesh::TriangleMesh turned = test::box({0, 0, 0}, size);
  turned.nodes *= Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return turned;
}

void expect_honest(const mesh::TriangleMesh& surface, double size_m, std::span<const double> exact, double top_hz) {
  const auto body = mesh::make_stuffed(surface, {.size_m = size_m, .order = 2}, false, "body", {});
  ASSERT_TRUE(body) << body.error().message;
  ASSERT_GT(body->mesh.gaps_m.size(), 0);
  const bake::BakeOptions options{.element = fem::Element::kTet10, .band_high_hz = top_hz, .points = 40};
  const auto baked = bake::bake(body->mesh, kSteel, options, "body");
  ASSERT_TRUE(baked) << baked.error().message;
  const modal::Bank& bank = baked->bank;
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&bank](std::size_t a, std::size_t b) { return bank.frequency_hz[a] < bank.frequency_hz[b]; });
  const std::size_t modes = std::min(order.size(), exact.size());
  ASSERT_GE(modes, 8u);
  std::size_t covered = 0;
  std::vector<double> stated_over_true;
  for (std::size_t m = 0; m < modes; ++m) {
    const double truth = std::abs(bank.frequency_hz[order[m]] / exact[m] - 1);
    const double stated = bank.frequency_error[order[m]];
    covered += truth <= stated;
    stated_over_true.push_back(stated / truth);
  }
  std::nth_element(stated_over_true.begin(), stated_over_true.begin() + static_cast<std::ptrdiff_t>(modes / 2),
                   stated_over_true.end());
  EXPECT_GE(static_cast<double>(covered), 0.95 * static_cast<double>(modes));
  EXPECT_LT(stated_over_true[modes / 2], 3);
}

TEST(StatedError, ItCoversWhatAStuffedBlockLacksAtItsEdges) {
  expect_honest(askew_box({0.1, 0.08, 0.06}), 0.012, reference::kBlock, 28e3);
}

TEST(StatedError, ItCoversWhatAStuffedBarLacksAtItsEdges) {
  expect_honest(askew_box({0.2, 0.01, 0.01}), 0.005, reference::kBar, 14e3);
}

}  // namespace
}  // namespace ringdown
