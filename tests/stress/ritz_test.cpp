// The oracle first: Rayleigh-Ritz against frequencies that were computed elsewhere and stored.
#include "tests/stress/ritz.h"

#include "tests/fem/reference_frequencies.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

template <std::size_t kCount>
void expect_all_near(const std::vector<double>& found, const std::array<double, kCount>& exact, double max) {
  for (std::size_t m = 0; m < std::min(found.size(), exact.size()); ++m) {
    EXPECT_NEAR(found[m] / exact[m], 1, max) << "mode " << m;
  }
}

TEST(Ritz, RitzsMethodHasTheStoredFrequenciesOfBlocks) {
  const Eigen::Vector3d block(0.1, 0.08, 0.06);
  expect_all_near(test::box_frequencies(block, {200e9, 0.3, 7850}, 50), reference::kBlock, 3e-5);
  expect_all_near(test::box_frequencies(block, {200e9, 0.49, 7850}, 50), reference::kSoftBlock, 3e-5);
}

TEST(Ritz, RitzsMethodHasTheStoredFrequenciesOfAThinPlate) {
  const Eigen::Vector3d plate(0.2, 0.2, 0.004);
  expect_all_near(test::box_frequencies(plate, {200e9, 0.3, 7850}, {18, 18, 3}, 39, 20), reference::kPlate, 4e-4);
}

// Polynomials of degree p are a subspace of those of degree p + 1, and a scaled body rings at scaled frequencies.
TEST(Ritz, RitzsFrequenciesOfATetrahedronFallWithTheDegree) {
  Eigen::Matrix<double, 4, 3> corners;
  corners << 0, 0, 0, 0.1, 0, 0, 0.02, 0.09, 0, 0.03, 0.02, 0.08;
  std::vector<double> coarser = test::tetrahedron_frequencies(corners, {200e9, 0.3, 7850}, 1, 6);
  for (int degree = 2; degree <= 8; ++degree) {
    const std::vector<double> finer = test::tetrahedron_frequencies(corners, {200e9, 0.3, 7850}, degree, 6);
    for (std::size_t m = 0; m < finer.size(); ++m) EXPECT_LT(finer[m], coarser[m] * (1 + 1e-9)) << degree;
    coarser = finer;
  }
  EXPECT_NEAR(coarser[0] / test::tetrahedron_frequencies(corners, {200e9, 0.3, 7850}, 7, 1)[0], 1, 3e-4);
  const auto twice = test::tetrahedron_frequencies(2 * corners, {200e9, 0.3, 7850}, 8, 6);
  for (std::size_t m = 0; m < twice.size(); ++m) EXPECT_NEAR(2 * twice[m] / coarser[m], 1, 1e-9);
}

}  // namespace
}  // namespace ringdown
