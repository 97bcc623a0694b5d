#include "engine/base/range.h"
#include "engine/base/result.h"

#include <gtest/gtest.h>

#include <string>

namespace ringdown {
namespace {

Result<int> read_nothing() { return fail(ErrorKind::too_large, "{} of {} bodies, at {:.3g} m", 3, "100%", 0.12345); }

TEST(Fail, WritesTheValuesIntoTheSentence) {
  EXPECT_EQ(read_nothing().error().message, "3 of 100% bodies, at 0.123 m");
  const Result<int> plain = fail(ErrorKind::usage, "{} stays as it is where no value is given");
  EXPECT_EQ(plain.error().message, "{} stays as it is where no value is given");
}

TEST(Fail, PassesOnTheKindAndTheSentenceOfAResult) {
  const Result<std::string> passed = fail(read_nothing());
  EXPECT_EQ(passed.error().kind, ErrorKind::too_large);
  EXPECT_EQ(passed.error().message, read_nothing().error().message);
  const Result<void> named = fail("bell.glb", read_nothing());
  EXPECT_EQ(named.error().kind, ErrorKind::too_large);
  EXPECT_EQ(named.error().message, "bell.glb: 3 of 100% bodies, at 0.123 m");
}

TEST(Digits, ANumberIsRoundedToTheNearestWithSoManyDigits) {
  EXPECT_EQ(to_digits(1234567, 3), 1230000);
  EXPECT_EQ(to_digits(-0.00098765, 2), -0.00099);
  EXPECT_EQ(to_digits(0.1 + 0.2, 9), 0.3);
  EXPECT_EQ(to_digits(0, 4), 0);
}

}  // namespace
}  // namespace ringdown
