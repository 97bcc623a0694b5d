// Pieces that consist of pieces: what the finer ones have together is what the coarser one had.
#include "engine/bake/shatter_body.h"
#include "tests/shatter/bodies.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ringdown::second_break_test {
namespace {

using modal::PieceBank;

constexpr int kRigid = 6;

// A pane in three pieces, which break into some eight in all.
const modal::Fracture& nested_pane() {
  static const modal::Fracture pane = [] {
    const mesh::TetMesh mesh = mesh::to_order(test::box_mesh({6, 4, 1}, {0.12, 0.08, 0.004}), 2);
    const bake::BakeOptions options{.element = test::element_of(mesh), .band_high_hz = 20e3, .interior = true};
    const modal::Material glass{"glass", 70e9, 0.22, 2500, {0.5, 2e-9}};
    const bake::Baked whole = bake::bake(test::checked(mesh), glass, options, "pane").value();
    const bake::Shatter shatter{.pieces = {3, 8}, .pattern = shatter::Pattern::kUniform, .band_high_hz = 150e3};
    return bake::shatter_body(whole, shatter, options).value();
  }();
  return pane;
}

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
Eigen::MatrixXd matrix_of(const std::vector<float>& values, std::size_t modes) {
  const auto rows = static_cast<Eigen::Index>(kRigid + modes);
  return Eigen::Map<const FloatRows>(values.data(), rows, std::ssize(values) / rows).cast<double>();
}

// A rigid motion of the body is one of its piece, and so one of the piece's piece.
TEST(SecondBreak, RigidMotionComesThroughCoarserPieces) {
  const auto& patterns = nested_pane().patterns;
  ASSERT_EQ(patterns.size(), 2u);
  for (const PieceBank& piece : patterns[1].pieces) {
    ASSERT_TRUE(piece.coarser);
    const PieceBank& coarser = patterns[0].pieces[*piece.coarser];
    const std::size_t modes = piece.bank.mode_count(), coarse_modes = coarser.bank.mode_count();
    const Eigen::MatrixXd through =
        matrix_of(piece.from_coarser, modes) * matrix_of(coarser.handover, coarse_modes).leftCols<kRigid>();
    EXPECT_LT((through - matrix_of(piece.handover, modes).leftCols<kRigid>()).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(SecondBreak, PiecesOfAPieceTakeItsMassAndNoMoreThanItsModesHave) {
  const auto& patterns = nested_pane().patterns;
  double lowest_share = 1;
  for (std::size_t i = 0; i < patterns[0].pieces.size(); ++i) {
    const PieceBank& coarser = patterns[0].pieces[i];
    const auto modes = static_cast<Eigen::Index>(coarser.bank.mode_count());
    ASSERT_GT(modes, 0);
    double mass_kg = 0;
    Eigen::RowVectorXd taken = Eigen::RowVectorXd::Zero(modes);
    for (const std::size_t k : modal::pieces_of_piece(nested_pane(), 0, i)) {
      const PieceBank& piece = patterns[1].pieces[k];
      mass_kg += piece.bank.mass->mass_kg;
      taken += matrix_of(piece.from_coarser, piece.bank.mode_count()).rightCols(modes).colwise().squaredNorm();
    }
    EXPECT_NEAR(mass_kg / coarser.bank.mass->mass_kg, 1, 1e-12);
    EXPECT_LE(taken.maxCoeff(), 1 + 1e-5);
    const auto lowest = std::ranges::min_element(coarser.bank.frequency_hz) - coarser.bank.frequency_hz.begin();
    lowest_share = std::min(lowest_share, taken[lowest]);
  }
  EXPECT_GT(lowest_share, 0.8) << "the band of the pieces is high";
}

TEST(SecondBreak, OnlyPiecesThatBreakAgainKnowTheirStress) {
  const auto& patterns = nested_pane().patterns;
  for (std::size_t i = 0; i < patterns[0].pieces.size(); ++i) {
    const PieceBank& piece = patterns[0].pieces[i];
    const auto again = modal::fracture_of_piece(nested_pane(), 0, i);
    ASSERT_EQ(again != nullptr, modal::pieces_of_piece(nested_pane(), 0, i).size() > 1);
    EXPECT_EQ(piece.stress.largest.size(), again ? piece.bank.mode_count() : 0);
    if (again) {
      EXPECT_GT(piece.skin_m2, piece.crack_area_m2);
      EXPECT_GT(again->patterns[0].crack_area_m2, 0);
    }
  }
  for (const PieceBank& piece : patterns[1].pieces) EXPECT_TRUE(piece.stress.largest.empty());
}

}  // namespace
}  // namespace ringdown::second_break_test
