// What a second opinion accepts and what it finds out. Most tests take modes that are right, spoil one, and compare.
#include "engine/solve/second_opinion.h"

#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

namespace ringdown::second_opinion_test {
namespace {

using solve::Method;

constexpr fem::Elastic kSteel{200e9, 0.3, 7850};

double lambda_of(double frequency_hz) { return std::pow(2 * M_PI * frequency_hz, 2); }

fem::System system_of(const mesh::TetMesh& mesh) {
  return fem::assemble(mesh::to_order(mesh, 2), kSteel, fem::Element::kTet10).value();
}

// A square plate: its modes that are not symmetric about a diagonal come in pairs of equal frequency.
const fem::System& square_plate() {
  static const fem::System plate = system_of(test::box_mesh({8, 8, 1}, {0.1, 0.1, 0.005}));
  return plate;
}

fem::System block() { return system_of(test::box_mesh({4, 4, 3}, {0.1, 0.08, 0.06})); }

TEST(SecondOpinion, ASecondOpinionAgreesWithEveryMethodOnBodiesWithFamiliesOfEqualFrequencies) {
  const auto agrees = [](const fem::System& system, double top_hz, const char* body, bool dense_too = false) {
    for (const Method method : {Method::kDense, Method::kSpectra, Method::kBlockLanczos}) {
      if (method == Method::kDense && !dense_too) continue;  // would take minutes
      const auto modes =
          solve::solve_modes(system, {.highest_lambda = lambda_of(top_hz), .method = method, .verify = true});
      ASSERT_TRUE(modes) << body << " by " << solve::method_name(method) << ": " << modes.error().message;
      EXPECT_GT(modes->agreement.modes, 0) << body;
      EXPECT_LT(modes->agreement.frequency, solve::kSameFrequency);
      EXPECT_LT(modes->agreement.angle, solve::kSameSpace);
      EXPECT_LT(modes->agreement.residual, solve::kSmallResidual);
    }
  };
  agrees(system_of(test::box_mesh({2, 2, 2}, {0.1, 0.1, 0.1})), 40e3, "cube", true);
  agrees(block(), 80e3, "block");
  agrees(square_plate(), 20e3, "plate");
}

TEST(SecondOpinion, SpectraAndBlockLanczosBothGiveSecondOpinions) {
  const fem::System system = block();
  solve::Pencil pencil(system, 1);
  const solve::EigenRequest request{.highest_lambda = lambda_of(60e3)};
  const solve::Count top = pencil.factor(request.highest_lambda, solve::Pencil::kUp).value();
  const solve::Eigenmodes modes = solve::solve_modes(system, request).value();
  const Progress unasked;
  for (const Method by : {Method::kSpectra, Method::kBlockLanczos}) {
    solve::SecondOpinion opinion(by, {1, request.highest_lambda}, request, unasked);
    ASSERT_TRUE(opinion.ask(pencil, top));
    EXPECT_GT(opinion.check(system, modes).value().modes, 0);
  }
}

TEST(SecondOpinion, ASecondOpinionStopsWhenToldTo) {
  bool asked = false;
  const auto modes = solve::solve_modes(block(), {.highest_lambda = lambda_of(60e3), .verify = true},
                                        [&asked](std::string_view stage, double) {
                                          asked = asked || stage == "second opinion";
                                          return !asked;
                                        });
  ASSERT_FALSE(modes);
  EXPECT_EQ(modes.error().kind, ErrorKind::cancelled);
}

// Modes of the plate that are right, and what Spectra finds about a shift between them.
class SpoiledModes : public testing::Test {
 protected:
  SpoiledModes() {
    modes = solve::solve_modes(system, request).value();
    solve::Pencil pencil(system, 1);
    const double sigma = 0.3 * request.highest_lambda;
    const solve::Count shift = pencil.factor(sigma, solve::Pencil::kDown).value();
    near = find_near(Method::kSpectra, pencil, shift, 14, request).value();
    first_above = shift.below;
    for (int m = modes.rigid; m + 1 < modes.lambda.size() && pair < 0; ++m) {
      const bool is_known = std::abs(modes.lambda[m] - near.shift.lambda) < 0.8 * near.radius;
      const bool is_below = modes.lambda[m + 1] < near.shift.lambda;
      if (is_known && is_below && modes.lambda[m + 1] < modes.lambda[m] * (1 + 1e-6)) pair = m;
    }
  }

  // The sentence of the disagreement; empty when there is none.
  [[nodiscard]] std::string sentence() const {
    solve::Agreement agreement;
    const Result<void> same = compare(system, modes, near, band, request, agreement);
    if (!same) return same.error().message;
    EXPECT_GT(agreement.modes, 0);
    return "";
  }

  void remove(int mode) {
    const Eigen::Index after = modes.lambda.size() - mode - 1;
    modes.lambda.segment(mode, after) = modes.lambda.tail(after).eval();
    modes.shapes.middleCols(mode, after) = modes.shapes.rightCols(after).eval();
    modes.lambda.conservativeResize(modes.lambda.size() - 1);
    modes.shapes.conservativeResize(Eigen::NoChange, modes.lambda.size());
  }

  const fem::System& system = square_plate();
  const solve::EigenRequest request{.highest_lambda = lambda_of(20e3), .method = Method::kBlockLanczos};
  const solve::Band band{0.001 * request.highest_lambda, request.highest_lambda};
  solve::Eigenmodes modes;
  solve::NearModes near;
  int first_above = 0, pair = -1;  // a mode above the shift; the first of two with one frequency, below it
};

TEST_F(SpoiledModes, ModesThatAreRightPass) {
  ASSERT_GE(pair, 0) << "the plate has no pair near the shift";
  EXPECT_EQ(sentence(), "");
}

TEST_F(SpoiledModes, AnyBasisOfAPairPasses) {
  const Eigen::VectorXd a = modes.shapes.col(pair), b = modes.shapes.col(pair + 1);
  modes.shapes.col(pair) = 0.6 * a - 0.8 * b;
  modes.shapes.col(pair + 1) = 0.8 * a + 0.6 * b;
  EXPECT_EQ(sentence(), "");
}

TEST_F(SpoiledModes, AFrequencyOffByATenMillionthIsFound) {
  modes.lambda[first_above] *= 1 + 2e-7;
  EXPECT_NE(sentence().find("mode " + std::to_string(first_above + 1 - modes.rigid) + " at "), std::string::npos)
      << sentence();
  EXPECT_NE(sentence().find("a relative difference of 1e-07, where 1e-08 is allowed"), std::string::npos) << sentence();
}

TEST_F(SpoiledModes, AShapeThatLeansTowardsAnotherIsFound) {
  modes.shapes.col(first_above) += 1e-4 * modes.shapes.col(modes.rigid);
  EXPECT_NE(sentence().find("lies at an angle of 0.0001"), std::string::npos) << sentence();
}

TEST_F(SpoiledModes, ASpaceThatLeansIsFoundWhateverItsBasis) {
  modes.shapes.col(pair) += 1e-4 * modes.shapes.col(modes.rigid);
  const Eigen::VectorXd a = modes.shapes.col(pair), b = modes.shapes.col(pair + 1);
  modes.shapes.col(pair) = 0.6 * a - 0.8 * b;
  modes.shapes.col(pair + 1) = 0.8 * a + 0.6 * b;
  EXPECT_NE(sentence().find("2 modes from mode "), std::string::npos) << sentence();
}

TEST_F(SpoiledModes, OneShapeInThePlaceOfTwoIsFound) {
  modes.shapes.col(pair + 1) = modes.shapes.col(pair);
  EXPECT_NE(sentence().find("lies at an angle of 1 "), std::string::npos) << sentence();
}

TEST_F(SpoiledModes, AMissingModeIsFound) {
  remove(first_above);
  EXPECT_NE(sentence().find("the number of modes near "), std::string::npos) << sentence();
}

TEST_F(SpoiledModes, OneMissingOfAPairIsFound) {
  remove(pair);
  EXPECT_NE(sentence().find(std::to_string(first_above) + " modes were counted below"), std::string::npos)
      << sentence();
}

TEST_F(SpoiledModes, AModeThatDoesNotExistIsFound) {
  modes.lambda[modes.lambda.size() - 1] = near.shift.lambda * (1 + 1e-3);
  EXPECT_NE(sentence().find("is 1 in the result and 0 by Spectra"), std::string::npos) << sentence();
}

// Both methods would share a fault of the factors; the residual is taken from K and M.
TEST_F(SpoiledModes, ModesOfOtherMatricesAreFoundByTheirResiduals) {
  fem::System stiffer = system;
  stiffer.stiffness.coeffRef(0, 0) *= 1.01;
  solve::Agreement agreement;
  const auto same = compare(stiffer, modes, near, band, request, agreement);
  ASSERT_FALSE(same);
  EXPECT_NE(same.error().message.find("solves K phi = lambda M phi to"), std::string::npos) << same.error().message;
}

}  // namespace
}  // namespace ringdown::second_opinion_test
