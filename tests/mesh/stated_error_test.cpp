// The error that a bank states against the true one, where the mesh's skin is not the body's surface.
#include "engine/bake/bake_object.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/mesh/sample_surfaces.h"
#include "tests/mesh/surface_files.h"
#include "tests/support/temporary_folder.h"

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

// A box that stands askew in any lattice, and a splinter that cuts its skin.
mesh::TriangleMesh splintered_box(const test::Vec& size) {
  const auto body = test::united(test::box({0, 0, 0}, size), test::box({-1e-4, 4e-3, 3e-3}, {1e-4, 4.2e-3, 3.2e-3}));
  mesh::TriangleMesh turned = body;
  turned.nodes *= Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return turned;
}

void expect_honest(const mesh::TriangleMesh& surface, std::span<const double> exact, double top_hz) {
  const test::TemporaryFolder folder;
  bake::ObjectRecipe recipe{.name = "body", .geometry = folder.write("body.ply", test::file_of(surface, ".ply"))};
  recipe.options.band_high_hz = top_hz;
  recipe.options.points = 40;
  const auto object = bake::bake_recipe(recipe, kSteel);
  ASSERT_TRUE(object) << object.error().message;
  const modal::Bank& bank = object->baked.bank;
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
  expect_honest(splintered_box({0.1, 0.08, 0.06}), reference::kBlock, 28e3);
}

TEST(StatedError, ItCoversWhatAStuffedBarLacksAtItsEdges) {
  expect_honest(splintered_box({0.2, 0.01, 0.01}), reference::kBar, 14e3);
}

}  // namespace
}  // namespace ringdown
