// Modes by SLEPc in two processes against those of solve_modes() in this one.
#include "engine/solve/eigensolver.h"

#include "engine/base/process/child_process.h"
#include "engine/solve/distributed_files.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace ringdown::distributed_test {
namespace {

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

double lambda_of(double frequency_hz) { return std::pow(2 * std::numbers::pi * frequency_hz, 2); }

fem::System block(test::Cells cells, const Eigen::Vector3d& size = {0.1, 0.08, 0.06}) {
  return fem::assemble(mesh::to_order(test::box_mesh(cells, size), 2), kSteel, fem::Element::kTet10).value();
}

#define SKIP_WITHOUT_SLEPC()                                                                                     \
  if (!find_beside("ringdown-modes-slepc")) GTEST_SKIP() << "ringdown-modes-slepc was not built: no SLEPc here"; \
  if (!run_child({.command = {"mpirun", "--version"}})) GTEST_SKIP() << "mpirun is not installed"

// How much of a shape lies in the space of others (all M-orthonormal): 1 when it is one of them, or a mixture.
double part_within(const Eigen::VectorXd& shape, const Eigen::MatrixXd& mass_others) {
  return (mass_others.transpose() * shape).squaredNorm();
}

TEST(Distributed, SlepcInTwoProcessesFindsTheModesOfOurSolver) {
  SKIP_WITHOUT_SLEPC();
  const fem::System system = block({4, 4, 3}, {0.1, 0.1, 0.06});  // two sides alike: many modes come in pairs
  const double top = lambda_of(75e3);
  const auto here = solve::solve_modes(system, {.highest_lambda = top}).value();
  const auto there =
      solve::solve_modes(system, {.highest_lambda = top, .method = solve::Method::kSlepc, .processes = 2});
  ASSERT_TRUE(there) << there.error().message;
  ASSERT_EQ(there->lambda.size(), here.lambda.size());
  EXPECT_GT(here.lambda.size(), 60);
  EXPECT_EQ(there->rigid, 6);
  EXPECT_LT(there->residuals.maxCoeff(), 1e-6);
  const Eigen::MatrixXd mass_shapes = fem::mass_times(system.node_mass, here.shapes);
  for (Eigen::Index m = 0; m < here.lambda.size(); ++m) {
    EXPECT_NEAR(there->lambda[m], here.lambda[m], 1e-8 * std::max(here.lambda[m], 1e-2 * top)) << m;
    Eigen::Index first = m, last = m;  // of the family of m
    const double near = 1e-6 * top;
    while (first > 0 && here.lambda[m] - here.lambda[first - 1] < near) --first;
    while (last + 1 < here.lambda.size() && here.lambda[last + 1] - here.lambda[m] < near) ++last;
    EXPECT_NEAR(part_within(there->shapes.col(m), mass_shapes.middleCols(first, last - first + 1)), 1, 1e-6) << m;
  }
  const Eigen::MatrixXd gram = there->shapes.transpose() * fem::mass_times(system.node_mass, there->shapes);
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Distributed, SlepcInOneProcessNeedsNoMpirun) {
  SKIP_WITHOUT_SLEPC();
  const fem::System system = block({3, 2, 2});
  const double top = lambda_of(60e3);
  const auto here = solve::solve_modes(system, {.highest_lambda = top}).value();
  const auto there =
      solve::solve_modes(system, {.highest_lambda = top, .method = solve::Method::kSlepc, .processes = 1});
  ASSERT_TRUE(there) << there.error().message;
  ASSERT_EQ(there->lambda.size(), here.lambda.size());
  for (Eigen::Index m = 6; m < here.lambda.size(); ++m) EXPECT_NEAR(there->lambda[m] / here.lambda[m], 1, 1e-8) << m;
}

TEST(Distributed, SlepcStopsWhenToldTo) {
  SKIP_WITHOUT_SLEPC();
  int calls = 0;
  const auto modes =
      solve::solve_modes(block({4, 4, 3}), {.highest_lambda = lambda_of(60e3), .method = solve::Method::kSlepc},
                         [&](auto, double) { return ++calls < 2; });
  ASSERT_FALSE(modes);
  EXPECT_EQ(modes.error().kind, ErrorKind::cancelled);
}

TEST(Distributed, SlepcRefusesMoreModesThanAllowedInOneSentence) {
  SKIP_WITHOUT_SLEPC();
  const fem::System system = block({3, 2, 2});
  const auto modes = solve::solve_modes(
      system, {.highest_lambda = lambda_of(60e3), .max_modes = 3, .method = solve::Method::kSlepc, .processes = 1});
  ASSERT_FALSE(modes);
  EXPECT_NE(modes.error().message.find("modes lie in the band"), std::string::npos) << modes.error().message;
  EXPECT_EQ(modes.error().message.find('\n'), std::string::npos);
}

// The files between the two programs: what is not whole is refused, whatever is missing of it.
class Files : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(Files, AProblemFileThatIsCutShortIsRefused) {
  const std::array<int, 4> starts = {0, 1, 2, 3}, columns = {0, 1, 2, 0};
  const std::array<double, 4> values = {5, 6, 7, 0};
  const solve::ProblemHeader header{
      .nodes = 1, .stiffness_entries = 3, .mass_entries = 1, .highest_lambda = 1, .tolerance = 1e-9, .max_modes = 9};
  const auto path = folder_ / "problem";
  ASSERT_TRUE(
      solve::write_problem(path, header, {starts, std::span(columns).first(3), std::span(values).first(3)},
                           {std::span(starts).first(2), std::span(columns).first(1), std::span(values).first(1)}));
  auto whole = solve::ProblemFile::open(path);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->stiffness_rows(1, 2).value().values, (std::vector<double>{6, 7}));
  EXPECT_EQ(whole->stiffness_rows(1, 2).value().starts, (std::vector<std::int64_t>{0, 1, 2}));
  EXPECT_EQ(whole->mass_rows(0, 1).value().values, (std::vector<double>{5}));
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
  for (const int cut : {1, 8, 100}) {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - static_cast<std::uintmax_t>(cut));
    EXPECT_FALSE(solve::ProblemFile::open(path)) << cut;
  }
}

TEST_F(Files, AProblemFileWithColumnsOutsideTheMatrixIsRefused) {
  const std::array<int, 4> starts = {0, 1, 2, 3}, columns = {0, 3, 2, 0};
  const std::array<double, 4> values = {5, 6, 7, 0};
  const solve::ProblemHeader header{
      .nodes = 1, .stiffness_entries = 3, .mass_entries = 1, .highest_lambda = 1, .tolerance = 1e-9, .max_modes = 9};
  const auto path = folder_ / "problem";
  ASSERT_TRUE(
      solve::write_problem(path, header, {starts, std::span(columns).first(3), std::span(values).first(3)},
                           {std::span(starts).first(2), std::span(columns).first(1), std::span(values).first(1)}));
  auto file = solve::ProblemFile::open(path);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->stiffness_rows(0, 1));
  EXPECT_FALSE(file->stiffness_rows(1, 1));
}

TEST_F(Files, ModesOfAnotherMeshAreRefused) {
  const std::vector<double> lambda = {1, 2}, shape = {1, 2, 3};
  const auto path = folder_ / "modes";
  ASSERT_TRUE(
      solve::write_modes(path, {.nodes = 1, .modes = 2}, lambda, [&](std::int64_t) { return std::span(shape); }));
  const auto modes = solve::read_modes(path, 1);
  ASSERT_TRUE(modes) << modes.error().message;
  EXPECT_EQ(modes->shapes, (std::vector<double>{1, 2, 3, 1, 2, 3}));
  EXPECT_FALSE(solve::read_modes(path, 2));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 8);
  EXPECT_FALSE(solve::read_modes(path, 1));
}

}  // namespace
}  // namespace ringdown::distributed_test
