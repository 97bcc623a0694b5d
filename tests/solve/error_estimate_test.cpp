// Estimated errors of frequencies against true ones.
#include "engine/fem/error_estimate.h"

#include "engine/fem/assembly.h"
#include "engine/solve/eigensolver.h"
#include "tests/fem/reference_frequencies.h"
#include "tests/fem/sample_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <span>

namespace ringdown::error_estimate_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850}, kSoft{200e9, 0.49, 7850};
constexpr std::array kElements = {fem::Element::kTet4, fem::Element::kTet10, fem::Element::kTet20,
                                  fem::Element::kTet35};

struct Solved {
  mesh::TetMesh mesh;
  Eigen::VectorXd lambda;
  Eigen::MatrixXd shapes;
};

Solved solved(const mesh::TetMesh& box, int order, const fem::Elastic& elastic, double top_hz) {
  Solved body{mesh::to_order(box, order), {}, {}};
  const fem::System system = fem::assemble(body.mesh, elastic, kElements[order - 1]).value();
  const auto modes = solve::solve_modes(system, {.highest_lambda = std::pow(2 * std::numbers::pi * top_hz, 2)}).value();
  const Eigen::Index elastic_modes = modes.lambda.size() - modes.rigid;
  body.lambda = modes.lambda.tail(elastic_modes);
  body.shapes = modes.shapes.rightCols(elastic_modes);
  return body;
}

struct Effectivity {
  double min = 1e9, max = 0, median = 0;
  int below_truth = 0, modes = 0;
};

// Estimate over truth for each mode whose truth the reference can tell, ascending, when the true frequencies are about
// the found ones less `share` of their estimated errors: on a coarse mesh neighbouring modes change places.
std::vector<double> ratios(const Eigen::VectorXd& found, const Eigen::VectorXd& errors, std::span<const double> exact,
                           double share) {
  std::vector<Eigen::Index> order(found.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return found[a] / (1 + share * errors[a]) < found[b] / (1 + share * errors[b]);
  });
  std::vector<double> ratios;
  for (std::size_t k = 0; k < exact.size() && k < order.size(); ++k) {
    const double truth = found[order[k]] / exact[k] - 1;
    if (truth > 1e-7) ratios.push_back(errors[order[k]] / truth);
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

Effectivity effectivity(const Solved& body, const fem::Elastic& elastic, std::span<const double> exact) {
  const Eigen::VectorXd errors = fem::frequency_errors(body.mesh, elastic, body.lambda, body.shapes).value();
  const Eigen::VectorXd found = body.lambda.cwiseSqrt() / (2 * std::numbers::pi);
  const std::vector<double> first = ratios(found, errors, exact, 0.5);
  const std::vector<double> all = ratios(found, errors, exact, 1 / first[first.size() / 2]);
  return {.min = all.front(),
          .max = all.back(),
          .median = all[all.size() / 2],
          .below_truth = static_cast<int>(std::lower_bound(all.begin(), all.end(), 1.0) - all.begin()),
          .modes = static_cast<int>(all.size())};
}

struct Case {
  const char* name;
  int order;
  test::Cells cells;
  Eigen::Vector3d size;
  fem::Elastic elastic;
  std::span<const double> exact;
};

class ErrorEstimate : public testing::TestWithParam<Case> {};

TEST_P(ErrorEstimate, EstimatedErrorLiesBetweenHalfAndFiveTimesTheTruthAndRarelyBelowIt) {
  const Case& body = GetParam();
  const double top = 1.12 * body.exact.back();
  const Effectivity e = effectivity(solved(test::box_mesh(body.cells, body.size), body.order, body.elastic, top),
                                    body.elastic, body.exact);
  RecordProperty("least", std::to_string(e.min));
  RecordProperty("median", std::to_string(e.median));
  RecordProperty("most", std::to_string(e.max));
  EXPECT_GE(e.modes, 3 * static_cast<int>(body.exact.size()) / 4);
  EXPECT_GE(e.min, 0.5);
  EXPECT_LE(e.max, 5);
  EXPECT_LE(e.below_truth, e.modes / 20);
}

const Eigen::Vector3d kBlockSize(0.1, 0.08, 0.06), kBarSize(0.2, 0.01, 0.01), kPlateSize(0.2, 0.2, 0.004);

INSTANTIATE_TEST_SUITE_P(
    References, ErrorEstimate,
    testing::Values(Case{"Block2", 2, {6, 5, 4}, kBlockSize, kSteel, reference::kBlock},
                    Case{"Block3", 3, {4, 3, 2}, kBlockSize, kSteel, reference::kBlock},
                    Case{"Block4", 4, {3, 2, 2}, kBlockSize, kSteel, reference::kBlock},
                    Case{"SoftBlock2", 2, {6, 5, 4}, kBlockSize, kSoft, reference::kSoftBlock},
                    Case{"SoftBlock3", 3, {4, 3, 3}, kBlockSize, kSoft, reference::kSoftBlock},
                    Case{"SoftBlock4", 4, {3, 2, 2}, kBlockSize, kSoft, reference::kSoftBlock},
                    Case{"Bar2", 2, {32, 2, 2}, kBarSize, kSteel, reference::kBar},
                    Case{"Bar3", 3, {20, 1, 1}, kBarSize, kSteel, reference::kBar},
                    Case{"Bar4", 4, {14, 1, 1}, kBarSize, kSteel, reference::kBar},
                    Case{"Plate2", 2, {22, 22, 1}, kPlateSize, kSteel, std::span(reference::kPlate).first(30)},
                    Case{"Plate3", 3, {12, 12, 1}, kPlateSize, kSteel, std::span(reference::kPlate).first(30)},
                    Case{"Plate4", 4, {8, 8, 1}, kPlateSize, kSteel, std::span(reference::kPlate).first(30)}),
    [](const auto& instance) { return instance.param.name; });

// Flat elements, ten times as long as thick, are where functions of one degree more lock without the relaxation.
TEST(ErrorEstimateInFlatElements, EstimatedErrorInFlatElementsStaysOfTheTruthsSize) {
  for (const auto& [order, cells] : {std::pair(2, 8), std::pair(3, 5)}) {
    const Solved body = solved(test::box_mesh({cells, cells, 1}, kPlateSize), order, kSteel, 1900);
    const Effectivity e = effectivity(body, kSteel, std::span(reference::kPlate).first(8));
    EXPECT_GE(e.min, 0.4) << order;
    EXPECT_LE(e.max, 2.5) << order;
  }
}

TEST(ErrorEstimateOfAnyMesh, EstimatedErrorIsTheSameForAnyNumberOfThreads) {
  const Solved body = solved(test::box_mesh({3, 2, 2}, kBlockSize), 3, kSteel, 60e3);
  const auto one = fem::frequency_errors(body.mesh, kSteel, body.lambda, body.shapes, 1).value();
  EXPECT_GT(body.lambda.size(), 64);
  EXPECT_EQ(one, fem::frequency_errors(body.mesh, kSteel, body.lambda, body.shapes, 3).value());
}

// Neither the numbers of the nodes, nor how the body lies in space, nor its size change a relative error.
TEST(ErrorEstimateOfAnyMesh, EstimatedErrorDoesNotDependOnNumbersPlaceOrSize) {
  Solved body =
      solved(test::bent(mesh::to_order(test::box_mesh({4, 2, 1}, {0.2, 0.05, 0.02}), 3), 3.0), 3, kSteel, 20e3);
  const auto before = fem::frequency_errors(body.mesh, kSteel, body.lambda, body.shapes).value();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Index nodes = body.mesh.nodes.rows(), modes = body.shapes.cols();
  const mesh::Points turned = 3.0 * body.mesh.nodes * turn.transpose();
  mesh::TetMesh mirror{mesh::Points(nodes, 3), body.mesh.elements};
  Eigen::MatrixXd shapes(3 * nodes, modes);
  for (Eigen::Index n = 0; n < nodes; ++n) {  // numbered from the other end
    const Eigen::Index other = nodes - 1 - n;
    mirror.nodes.row(other) = turned.row(n);
    shapes.middleRows<3>(3 * other) = std::pow(3.0, -1.5) * turn * body.shapes.middleRows<3>(3 * n);
  }
  mirror.elements = static_cast<std::int32_t>(nodes - 1) - body.mesh.elements.array();
  const auto after = fem::frequency_errors(mirror, kSteel, body.lambda / 9, shapes).value();
  for (Eigen::Index m = 0; m < modes; ++m) EXPECT_NEAR(after[m] / before[m], 1, 2e-3) << m;
}

// Half the mesh size divides the estimates by as much as the errors, which the exact frequencies tell.
TEST(ErrorEstimateOfAnyMesh, EstimatedErrorFallsAsFastAsTheTrueOne) {
  const auto sums = [](test::Cells cells) {  // of estimates, and of errors
    const Solved body = solved(test::box_mesh(cells, kBlockSize), 2, kSteel, 26e3);
    const auto errors = fem::frequency_errors(body.mesh, kSteel, body.lambda, body.shapes).value();
    double truth = 0;
    for (int m = 0; m < 5; ++m) truth += std::sqrt(body.lambda[m]) / (2 * std::numbers::pi) / reference::kBlock[m] - 1;
    return std::pair(errors.head(5).sum(), truth);
  };
  const auto coarse = sums({3, 2, 2}), fine = sums({6, 4, 4});
  EXPECT_GT(coarse.second / fine.second, 6);
  EXPECT_NEAR((coarse.first / fine.first) / (coarse.second / fine.second), 1, 0.3);
}

}  // namespace
}  // namespace ringdown::error_estimate_test
