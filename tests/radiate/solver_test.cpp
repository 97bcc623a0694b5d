// What the solver promises beside physics: flow is kept, threads do not matter, broken input is refused.
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_band.h"
#include "engine/radiate/wave_solver.h"
#include "tests/radiate/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::solver_test {
namespace {

radiate::Body shaking_box() {
  radiate::Body body{.surface = box({0.12, 0.05, 0.003}, 0.004), .flow = {}, .frequency_hz = {800, 805, 2000, 3000}};
  body.flow = sample(
      body.surface, 4,
      [](int m, const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
        return normal[2] * std::cos((20 + 10 * m) * at[0]) + normal[0] * std::sin(at[1] * 30);
      },
      0.003);
  return body;
}

TEST(Radiation, SkinsOfEverySizeKeepTheNetFlowAndTheVolume) {
  radiate::Body body{.surface = sphere(0.1, 14), .flow = {}, .frequency_hz = {500}};
  body.flow = sample(
      body.surface, 1, [](int, const Eigen::Vector3d& at, const auto&) { return 0.001 + at[0] * 10; }, 0.02);
  const auto original = radiate::Original::of(body);
  ASSERT_TRUE(original) << original.error().message;
  const double net = body.flow.flow.cast<double>().sum(), moved = body.flow.flow.cast<double>().cwiseAbs().sum();
  for (const double side : {0.006, 0.012, 0.025, 0.04}) {
    const auto skin = radiate::skin_of(*original, side);
    ASSERT_TRUE(skin) << skin.error().message;
    EXPECT_NEAR((skin->flow[0].cast<double>().sum() - net) / moved, 0, 1e-5) << "side " << side;
    EXPECT_NEAR(skin->panels.volume() / original->panels->volume(), 1, 0.01) << "side " << side;
    const double nodes = skin->panels.area() / (side * side * std::sqrt(3.0) / 2);
    EXPECT_NEAR(skin->panels.node_count() / nodes, 1, 0.35) << "side " << side;
  }
}

TEST(Radiation, DoesNotDependOnTheNumberOfThreads) {
  const radiate::Body body = shaking_box();
  const auto one = radiate::solve(body, {}, {.threads = 1}), two = radiate::solve(body, {}, {.threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t m = 0; m < 4; ++m) EXPECT_EQ(one->modes[m].power_w, two->modes[m].power_w);
  EXPECT_EQ(modal::pack(one->maps).bytes, modal::pack(two->maps).bytes);
}

TEST(WaveBand, GivesTheMatricesThatAreComputedByThemselvesToATenthPerCent) {
  radiate::Body body{.surface = box({0.12, 0.05, 0.003}, 0.004), .flow = {}, .frequency_hz = {5000}};
  body.flow = sample(
      body.surface, 1, [](int, const auto&, const Eigen::Vector3d& normal) { return normal[2]; }, 0.003);
  const double k = 150;
  for (const int mirrors : {0, 3}) {
    const auto original = radiate::Original::of(body, mirrors);
    ASSERT_TRUE(original) << original.error().message;
    const auto skin = radiate::skin_of(*original, 2 * 3.14159 / (3 * k));  // three triangles in a wavelength
    ASSERT_TRUE(skin) << skin.error().message;
    const radiate::WaveBand band(*skin, k / radiate::kWidestBand, k, 20, 2);
    radiate::ClassMatrices from_band, by_itself;
    for (const double share : {1.0, 0.96, 0.88, 0.82, 1 / radiate::kWidestBand}) {
      band.matrices_at(share * k, from_band);
      radiate::class_matrices(*skin, share * k, band.coupling(), by_itself);
      ASSERT_EQ(by_itself.size(), std::size_t{1} << mirrors);
      for (std::size_t c = 0; c < by_itself.size(); ++c) {
        EXPECT_LT((from_band[c] - by_itself[c]).norm() / by_itself[c].norm(), 1e-3)
            << "k " << share * k << " class " << c;
      }
    }
  }
}

TEST(WaveSolver, MultipliesRowsByAnyNumberOfColumns) {
  for (const int size : {1, 2, 17, 40}) {
    const radiate::ComplexMatrix matrix = radiate::ComplexMatrix::Random(size, size);
    for (const int columns : {1, 2, 3, 4, 7}) {
      const Eigen::MatrixXcf right = Eigen::MatrixXcf::Random(size, columns);
      EXPECT_LT((radiate::multiply(matrix, right) - matrix * right).norm(), 1e-5 * size) << size << " x " << columns;
    }
  }
}

TEST(Radiation, LevelsAtOtherWavenumbersAreThoseOfAModeThatHasThem) {
  radiate::Body body{.surface = sphere(0.1, 12), .flow = {}, .frequency_hz = {400, 800}};
  body.flow = sample(
      body.surface, 2, [](int, const Eigen::Vector3d& at, const auto&) { return at[2] * 10; }, 0.02);
  const auto radiation = radiate::solve(body, {}, {.threads = 1});
  ASSERT_TRUE(radiation) << radiation.error().message;
  const auto& modes = radiation->maps.modes;
  EXPECT_TRUE(modal::covers(modes[0], modes[1].wavenumber_rad_m));
  EXPECT_NEAR(modal::level_ratio(modes[0], modes[1].wavenumber_rad_m) / (modal::rms(modes[1]) / modal::rms(modes[0])),
              1, 0.02);
}

TEST(Radiation, StopsWhenAskedTo) {
  const auto stopped = radiate::solve(shaking_box(), {}, {.progress = [](std::string_view, double) { return false; }});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::cancelled);
}

TEST(Radiation, RefusesOpenSurfacesThoseTurnedInsideOutAndFlowOfTheWrongSize) {
  radiate::Body open = shaking_box(), inward = open, wrong = open;
  open.surface.triangles.conservativeResize(open.surface.triangles.rows() - 1, 3);
  inward.surface.triangles.col(0).swap(inward.surface.triangles.col(1));
  wrong.frequency_hz.pop_back();
  for (const radiate::Body* body : {&open, &inward, &wrong}) {
    const auto refused = radiate::solve(*body, {}, {.threads = 1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::bad_input) << refused.error().message;
  }
}

}  // namespace
}  // namespace ringdown::solver_test
