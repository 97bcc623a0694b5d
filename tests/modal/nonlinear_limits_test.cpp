// Nonlinear terms that no body has are refused when a bank is read, by a sentence that says which and why; those of
// real bodies, which are far below, are not.
#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace ringdown::modal {
namespace {

constexpr double kThickness_m = 0.002;

// Two modes of 200 and 300 Hz, which move what they move most by 1 and 4 kg^-1/2. `stretching` is how hard each pair
// stretches the body over how hard it bends it, when it is bent by its thickness; `curving` the share of a mode's own
// strain that the functions share.
Bank plate(double stretching, double curving = 0.5) {
  Bank bank = ringdown::test::single_mode_bank(200, 1);
  bank.frequency_hz.push_back(300);
  bank.decay_per_s.push_back(1);
  bank.radiation->maps.modes.push_back(ringdown::test::even_field(300));
  bank.shapes.insert(bank.shapes.end(), bank.point_count(), {0, 0, 4});
  const double omega[] = {2 * std::numbers::pi * 200, 2 * std::numbers::pi * 300};
  const double amplitude[] = {kThickness_m / 1, kThickness_m / 4};
  NonlinearTerms terms{.modes = {0, 1}, .thickness_m = kThickness_m};
  for (const auto& [i, j] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1)}) {
    terms.bending.push_back(
        static_cast<float>(stretching * std::sqrt(omega[i] * omega[j] / (amplitude[i] * amplitude[j]))));
  }
  for (const double w : omega) terms.curving.push_back(static_cast<float>(curving * w));
  bank.nonlinear = terms;
  return bank;
}

std::string refusal(const Bank& bank) {
  const Result<Bank> read = parse_bank(to_glb(bank), "plate.glb");
  return read ? "" : read.error().message;
}

TEST(NonlinearLimits, TermsOfRealBodiesAndFarBeyondAreRead) {
  for (const double stretching : {0.0, 0.65, 10.0, 900.0}) EXPECT_EQ(refusal(plate(stretching)), "");
  EXPECT_EQ(refusal(plate(0.65, 1.9)), "");
}

TEST(NonlinearLimits, ABodyThatWouldStretchAThousandTimesAsHardAsItBendsIsRefused) {
  for (const double stretching : {1100.0, -1100.0, 1e12, 1e25}) {
    const std::string sentence = refusal(plate(stretching));
    EXPECT_NE(sentence.find("nonlinear.bending"), std::string::npos) << stretching << ": " << sentence;
    EXPECT_NE(sentence.find("mode"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("bake"), std::string::npos) << sentence;
  }
}

TEST(NonlinearLimits, OneWrongPairAmongManyIsNamed) {
  Bank bank = plate(0.65);
  bank.nonlinear->bending[1] *= 1e12F;
  EXPECT_NE(refusal(bank).find("modes 0 and 1"), std::string::npos) << refusal(bank);
}

TEST(NonlinearLimits, MoreEnergyThanTheModeHasIsRefused) {
  for (const double curving : {2.1, -2.1, 1e12}) {
    const std::string sentence = refusal(plate(0.65, curving));
    EXPECT_NE(sentence.find("nonlinear.curving"), std::string::npos) << curving << ": " << sentence;
  }
}

TEST(NonlinearLimits, AThicknessIsThatOfABody) {
  for (const double thickness_m : {0.0, -1.0, 1e-10, 1e-300, 1001.0, 1e300}) {
    Bank bank = plate(1e-9, 0);
    bank.nonlinear->thickness_m = thickness_m;
    EXPECT_NE(refusal(bank).find("nonlinear.thickness"), std::string::npos) << thickness_m << ": " << refusal(bank);
  }
}

TEST(NonlinearLimits, AModeThatMovesNoPointHasNoTerms) {
  Bank bank = plate(0.65);
  for (std::size_t p = 0; p < bank.point_count(); ++p) bank.shapes[p] = {0, 0, 0};
  EXPECT_NE(refusal(bank).find("nonlinear.bending"), std::string::npos) << refusal(bank);
}

}  // namespace
}  // namespace ringdown::modal
