// Pieces that break again, in the bank's file: written, read, scaled; and broken files.
#include "engine/modal/scaled_bank.h"
#include "tests/modal/fracture/breakable_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::modal::fracture_file_test {
namespace {

using test::parse;
using test::written;

// The same body, whose second pattern is at the first one's place and nested in it.
Bank nested_bank() {
  Bank bank = breakable_bank();
  Fracture fracture = *bank.fracture;
  fracture.patterns[1].at_m = fracture.patterns[0].at_m;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> entry(-1, 1);
  for (std::size_t i = 0; i < 3; ++i) {
    PieceBank& piece = fracture.patterns[1].pieces[i];
    piece.coarser = i == 1 ? 1 : 0;
    const std::size_t columns = kRigidMotions + fracture.patterns[0].pieces[*piece.coarser].bank.mode_count();
    for (std::size_t k = 0; k < (kRigidMotions + piece.bank.mode_count()) * columns; ++k)
      piece.from_coarser.push_back(
          std::ldexp(std::round(std::ldexp(entry(random), 17)), -17));  // as packed files have it
  }
  PieceBank& first = fracture.patterns[0].pieces[0];
  first.crack_area_m2 = 0.25;
  first.skin_m2 = 0.75;
  first.stress = {
      .positions = {{1, 2, 3}, {4, 5, 6}}, .stress = std::vector<float>(30, 0.5F), .largest = {2, 3, 4, 5, 6}};
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
  return bank;
}

TEST(FractureFile, PiecesOfPiecesComeBackAsTheyWentIn) {
  const Bank bank = nested_bank();
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const std::string file = written(bank, compression);
    const auto back = parse(file);
    ASSERT_TRUE(back) << back.error().message;
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t i = 0; i < bank.fracture->patterns[p].pieces.size(); ++i) {
        const PieceBank &a = bank.fracture->patterns[p].pieces[i], &b = back->fracture->patterns[p].pieces[i];
        expect_same_piece(a, b, compression == Compression::none);
        EXPECT_EQ(a.coarser, b.coarser);
        EXPECT_EQ(a.from_coarser, b.from_coarser);
        EXPECT_EQ(a.crack_area_m2, b.crack_area_m2);
        EXPECT_EQ(a.skin_m2, b.skin_m2);
        EXPECT_EQ(a.stress.positions, b.stress.positions);
        EXPECT_EQ(a.stress.stress, b.stress.stress);
        EXPECT_EQ(a.stress.largest, b.stress.largest);
      }
    }
    EXPECT_EQ(written(*back, compression), file);
  }
}

TEST(FractureFile, APieceBreaksIntoThePiecesThatBelongToIt) {
  const Fracture fracture = *nested_bank().fracture;
  EXPECT_EQ(pieces_of_piece(fracture, 0, 0), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(pieces_of_piece(fracture, 1, 0), std::vector<std::size_t>{});
  EXPECT_EQ(fracture_of_piece(fracture, 0, 1), nullptr) << "one piece alone belongs to it";
  const auto again = fracture_of_piece(fracture, 0, 0);
  ASSERT_TRUE(again);
  ASSERT_EQ(again->patterns.size(), 1u);
  EXPECT_EQ(again->patterns[0].crack_area_m2, 0.25);
  EXPECT_EQ(again->skin_m2, 0.75);
  ASSERT_EQ(again->patterns[0].pieces.size(), 2u);
  EXPECT_EQ(again->patterns[0].pieces[1].bank.name, "body.5");
  EXPECT_EQ(again->patterns[0].pieces[1].handover, fracture.patterns[1].pieces[2].from_coarser);
  EXPECT_NEAR(again->patterns[0].pieces[1].near_m, 0.05 - 0.01, 1e-12) << "from where the piece begins";
}

TEST(FractureFile, AModeThatNoLongerRingsLeavesThePiecesOfItsPiece) {
  Bank bank = nested_bank();
  Fracture fracture = *bank.fracture;
  Bank& piece = fracture.patterns[0].pieces[0].bank;
  for (double& decay : piece.decay_per_s) decay = 1e-6;
  piece.decay_per_s[2] = 0.01 * piece.frequency_hz[2];
  piece.material->damping = {0, 0};
  const PieceBank before = fracture.patterns[1].pieces[2];
  const Fracture softer = scaled(fracture, {.alpha = 1e5, .beta = 1e5});
  const PieceBank& after = softer.patterns[1].pieces[2];
  ASSERT_EQ(softer.patterns[0].pieces[0].bank.mode_count(), 4u);
  ASSERT_EQ(after.from_coarser.size(), (kRigidMotions + after.bank.mode_count()) * (kRigidMotions + 4));
  for (std::size_t row = 0; row < kRigidMotions; ++row) {
    for (std::size_t column = 0; column < kRigidMotions + 4; ++column) {
      const std::size_t old = column < kRigidMotions + 2 ? column : column + 1;
      EXPECT_EQ(after.from_coarser[row * (kRigidMotions + 4) + column],
                before.from_coarser[row * (kRigidMotions + 5) + old]);
    }
  }
  EXPECT_EQ(softer.patterns[0].pieces[0].stress.largest, (std::vector<float>{2, 3, 5, 6}));
}

TEST(FractureFile, AScaledPieceBreaksAsAScaledBody) {
  const Fracture before = *nested_bank().fracture, after = scaled(before, {.size = 2});
  EXPECT_EQ(after.patterns[1].pieces[0].from_coarser, before.patterns[1].pieces[0].from_coarser);
  EXPECT_EQ(after.patterns[0].pieces[0].crack_area_m2, 4 * 0.25);
  EXPECT_EQ(after.patterns[0].pieces[0].skin_m2, 4 * 0.75);
  EXPECT_NEAR(after.patterns[0].pieces[0].stress.largest[0], 2 * std::pow(2, -2.5), 1e-6);
  EXPECT_EQ(after.patterns[0].pieces[0].stress.positions[1], (Vec3f{8, 10, 12}));
}

const std::vector<Damage>& damages_of_nesting() {
  const auto finer = [](GlbParts& p) -> Json& { return fracture_in(p)["patterns"][1]; };
  static const std::vector<Damage> all = {
      {"CoarserPastTheEnd", [=](GlbParts& p) { finer(p)["pieces"][0]["coarser"] = 2; }, "coarser"},
      {"CoarserHuge", [=](GlbParts& p) { finer(p)["pieces"][0]["coarser"] = 1e300; }, "coarser"},
      {"CoarserNegative", [=](GlbParts& p) { finer(p)["pieces"][0]["coarser"] = -1; }, "coarser"},
      {"CoarserText", [=](GlbParts& p) { finer(p)["pieces"][0]["coarser"] = "body"; }, "coarser"},
      {"CoarserMissingOnce", [=](GlbParts& p) { finer(p)["pieces"][2].erase("coarser"); }, "coarser"},
      {"CoarserInTheFirstPattern", [](GlbParts& p) { piece_in(p)["coarser"] = 0; }, "coarser"},
      {"NestedInAnotherPlace", [=](GlbParts& p) { finer(p)["at"][0] = 3; }, "coarser"},
      {"MatrixMissing", [=](GlbParts& p) { finer(p).erase("handoverFromCoarser"); }, "handoverFromCoarser"},
      {"MatrixOfTheBody", [=](GlbParts& p) { finer(p)["handoverFromCoarser"] = finer(p)["handover"]; },
       "handoverFromCoarser"},
      {"CoarserOfOtherModes", [=](GlbParts& p) { finer(p)["pieces"][0]["coarser"] = 1; }, "handoverFromCoarser"},
      {"StressOfTooFewModes",
       [](GlbParts& p) {
         const auto accessor = piece_in(p)["stress"]["largest"].get<std::size_t>();
         p.json["accessors"][accessor]["count"] = 4;
       },
       "largest"},
      {"SkinNegative", [](GlbParts& p) { piece_in(p)["skinArea"] = -1; }, "skinArea"},
      {"CracksHuge", [](GlbParts& p) { piece_in(p)["crackArea"] = 1e300; }, "crackArea"},
  };
  return all;
}

class BrokenNesting : public testing::TestWithParam<std::size_t> {};

TEST_P(BrokenNesting, BrokenPiecesOfPiecesAreRefusedByTheNameOfTheirField) {
  const Damage& damage = damages_of_nesting()[GetParam()];
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    GlbParts parts(written(nested_bank(), compression));
    damage.change(parts);
    const auto bank = parse(parts.join());
    ASSERT_FALSE(bank);
    EXPECT_NE(bank.error().message.find(damage.expected), std::string::npos) << bank.error().message;
    EXPECT_LT(bank.error().message.size(), 300u) << "one sentence: " << bank.error().message;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, BrokenNesting, testing::Range(std::size_t{0}, damages_of_nesting().size()),
                         [](const auto& each) { return std::string(damages_of_nesting()[each.param].name); });

}  // namespace
}  // namespace ringdown::modal::fracture_file_test
