#include "engine/base/realtime.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown {
namespace {

double halved(double value) {
  volatile double x = value;
  x = x * 0.5;
  return x;
}

TEST(DenormalGuard, DenormalResultsAndOperandsAreFlushedWhileTheGuardLives) {
  constexpr double kMinNormal = std::numeric_limits<double>::min();
  EXPECT_GT(halved(kMinNormal), 0);
  {
    const DenormalGuard guard;
    EXPECT_EQ(halved(kMinNormal), 0);
    volatile double denormal = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(denormal * 1e300, 0);
  }
  EXPECT_GT(halved(kMinNormal), 0) << "the mode of the thread was not put back";
}

}  // namespace
}  // namespace ringdown
