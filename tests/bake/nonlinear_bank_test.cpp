// Nonlinear terms in a bank's file, and what other modes and other sizes make of them.
#include "engine/modal/bank_file.h"
#include "engine/modal/mode_choice.h"
#include "engine/modal/scaled_bank.h"
#include "tests/bake/struck_plate.h"
#include "tests/support/temporary_folder.h"

namespace ringdown::synth::test {
namespace {

modal::Bank plate_bank() {
  Plate plate = steel_plate();
  plate.curving = 0.1;
  return map_of(plate, true, 12)->bank();
}

TEST(NonlinearBank, AFileKeepsEveryTerm) {
  const ringdown::test::TemporaryFolder folder;
  modal::Bank bank = plate_bank();
  bank.nonlinear->residual = 0.25;
  bank.nonlinear->errors.assign(kModes, 0.125);
  const auto path = folder.path() / "plate.glb";
  ASSERT_TRUE(modal::write_bank(bank, path));
  const Result<modal::Bank> read = modal::read_bank(path);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_TRUE(read->nonlinear);
  EXPECT_EQ(read->nonlinear->modes, bank.nonlinear->modes);
  EXPECT_EQ(read->nonlinear->bending, bank.nonlinear->bending);
  EXPECT_EQ(read->nonlinear->curving, bank.nonlinear->curving);
  EXPECT_EQ(read->nonlinear->errors, bank.nonlinear->errors);
  EXPECT_EQ(read->nonlinear->residual, 0.25);
  EXPECT_EQ(read->nonlinear->thickness_m, kThickness_m);
  EXPECT_EQ(read->nonlinear->coupled, 12U);
}

TEST(NonlinearBank, AFileWhoseArraysDoNotFitIsRefused) {
  const ringdown::test::TemporaryFolder folder;
  modal::Bank bank = plate_bank();
  bank.nonlinear->bending.pop_back();
  const auto path = folder.path() / "plate.glb";
  ASSERT_TRUE(modal::write_bank(bank, path));
  const Result<modal::Bank> read = modal::read_bank(path);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("nonlinear.bending has"), std::string::npos) << read.error().message;
}

// By dimensions: H is in m^-1.5 kg^-0.5 times the square root of a modulus over a density, g in 1/(m s).
TEST(NonlinearBank, AScaledBankHasScaledTerms) {
  const modal::Bank bank = plate_bank();
  const modal::Bank scaled = modal::scaled(bank, {.density = 9, .stiffness = 4, .size = 2});
  ASSERT_TRUE(scaled.nonlinear);
  const modal::NonlinearTerms &before = *bank.nonlinear, &after = *scaled.nonlinear;
  ASSERT_EQ(after.mode_count(), before.mode_count());
  EXPECT_FLOAT_EQ(after.h(1, 3, 2), static_cast<float>(2.0 / 9 * std::pow(2, -3.5)) * before.h(1, 3, 2));
  EXPECT_FLOAT_EQ(after.g(1, 3), 2.0F / 3 / 2 * before.g(1, 3));
  EXPECT_EQ(after.thickness_m, 2 * before.thickness_m);
}

TEST(NonlinearBank, ModesThatAreLeftOutTakeTheirTermsWithThem) {
  modal::Bank bank = plate_bank();
  const modal::NonlinearTerms all = *bank.nonlinear;
  modal::take_modes(bank, {5, 2, 9});
  const modal::NonlinearTerms& few = *bank.nonlinear;
  ASSERT_EQ(few.mode_count(), 3U);
  const std::vector<std::size_t> before = {5, 2, 9};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(few.h(1, i, j), all.h(1, before[few.modes[i]], before[few.modes[j]]));
    EXPECT_EQ(few.g(1, i), all.g(1, before[few.modes[i]]));
  }
}

}  // namespace
}  // namespace ringdown::synth::test
