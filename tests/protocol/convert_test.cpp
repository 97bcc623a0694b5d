#include "protocol/convert.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown::protocol {
namespace {

constexpr ArgumentSpec number(double min, double max) {
  return {.name = "n", .type = ValueType::number, .unit = "m", .min = min, .max = max};
}
constexpr ArgumentSpec integer(double min, double max) {
  return {.name = "n", .type = ValueType::integer, .min = min, .max = max};
}

TEST(Convert, AllFourNumberTypesMeanTheSame) {
  const ArgumentSpec spec = number(-10, 10);
  for (const wire::Argument& three :
       {wire::Argument(3), wire::Argument(std::int64_t{3}), wire::Argument(3.f), wire::Argument(3.0)}) {
    EXPECT_EQ(convert(spec, three), Value(3.0));
    EXPECT_EQ(convert(integer(0, 5), three), Value(std::int32_t{3}));
  }
}

TEST(Convert, LimitsOfAnArgumentAreAcceptedAndTheNextNumberIsNot) {
  const ArgumentSpec spec = number(-1, 2);
  EXPECT_TRUE(convert(spec, -1.0));
  EXPECT_TRUE(convert(spec, 2.0));
  EXPECT_FALSE(convert(spec, std::nextafter(2.0, 3.0)));
  EXPECT_FALSE(convert(spec, std::nextafter(-1.0, -3.0)));
}

TEST(Convert, TextThatIsNotANumberIsNeverReadAsOne) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const ArgumentSpec widest = number(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
  for (const wire::Argument& bad : {wire::Argument(std::numeric_limits<float>::quiet_NaN()), wire::Argument(kInfinity),
                                    wire::Argument(-kInfinity), wire::Argument("3"), wire::Argument("")}) {
    EXPECT_FALSE(convert(widest, bad));
  }
}

TEST(Convert, OnlyWholeNumbersAreIntegers) {
  const ArgumentSpec spec = integer(-2147483648.0, 2147483647.0);
  for (const wire::Argument& bad :
       {wire::Argument(0.5f), wire::Argument(1e-300), wire::Argument(1e20), wire::Argument(2147483648.0),
        wire::Argument(std::int64_t{1} << 62), wire::Argument(std::numeric_limits<double>::quiet_NaN())}) {
    EXPECT_FALSE(convert(spec, bad));
  }
  EXPECT_EQ(convert(spec, -0.0), Value(std::int32_t{0}));
}

TEST(Convert, ARefusalSaysWhatItGotAndWhatItWants) {
  EXPECT_EQ(convert(number(0, 0.1), 3).error().message, "is 3; it must be a number from 0 to 0.1 m");
  EXPECT_EQ(convert(integer(0, 9), 0.5).error().message, "is 0.5; it must be a whole number from 0 to 9");
  EXPECT_EQ(convert(number(0, 1), "x").error().message, "is the text 'x'; it must be a number from 0 to 1 m");
  EXPECT_EQ(convert(number(0, 1), std::numeric_limits<float>::quiet_NaN()).error().message,
            "is not a number (NaN); it must be a number from 0 to 1 m");
}

}  // namespace
}  // namespace ringdown::protocol
