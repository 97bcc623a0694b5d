#include "engine/base/range.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

TEST(Fraction, FractionsAreReadAsNumbersOrPercentages) {
  EXPECT_DOUBLE_EQ(parse_fraction("0.1%").value(), 1e-3);
  EXPECT_DOUBLE_EQ(parse_fraction("0.1 %").value(), 1e-3);
  EXPECT_DOUBLE_EQ(parse_fraction("2e-4").value(), 2e-4);
  EXPECT_DOUBLE_EQ(parse_fraction("100%").value(), 1);
}

TEST(Fraction, TextsThatAreNotFractionsAreRefused) {
  for (const char* text : {"", "%", "much", "0.1 percent", "0.1%%", "1 2", "nan", "inf%", "1% "}) {
    EXPECT_FALSE(parse_fraction(text)) << text;
  }
}

TEST(Fraction, PercentagesAreWrittenWithTwoSignificantDigits) {
  EXPECT_EQ(as_percent(1.234e-3), "0.12 %");
  EXPECT_EQ(as_percent(0.5), "50 %");
  EXPECT_EQ(as_percent(0), "0 %");
}

}  // namespace
}  // namespace ringdown
