// The meter of the audio callback, fed with callbacks that take as long as the test makes them.
#include "server/load_meter.h"

#include <gtest/gtest.h>

#include <thread>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;

// A callback whose frames last `period_s`.
void callback(LoadMeter& meter, double period_s, std::chrono::microseconds takes, bool deadline = true) {
  meter.begin(1000, 1000 / period_s);
  std::this_thread::sleep_for(takes);
  meter.end(deadline);
}

TEST(LoadMeter, ACallbackLongerThanItsPeriodIsAMissAndItsXrunOurs) {
  LoadMeter meter;
  for (int i = 0; i < 10; ++i) callback(meter, 10, 0us);
  meter.note_xrun();
  EXPECT_EQ(meter.read().misses, 0);
  EXPECT_EQ(meter.read().xruns, 1);
  EXPECT_EQ(meter.read().own_xruns, 0) << "somebody else's";
  callback(meter, 1e-4, 1000us);
  meter.note_xrun();
  EXPECT_EQ(meter.read().misses, 1);
  EXPECT_EQ(meter.read().own_xruns, 1);
  meter.note_xrun();
  EXPECT_EQ(meter.read().own_xruns, 1) << "one miss explains one xrun";
  EXPECT_GE(meter.read().peak, 10);
}

TEST(LoadMeter, AnXrunIsOursWhileTheLateCallbackStillRuns) {
  LoadMeter meter;
  meter.begin(1000, 1e7);
  std::this_thread::sleep_for(1ms);
  meter.note_xrun();
  meter.end();
  meter.note_xrun();
  EXPECT_EQ(meter.read().xruns, 2);
  EXPECT_EQ(meter.read().own_xruns, 1);
}

TEST(LoadMeter, FreewheelMissesNothing) {
  LoadMeter meter;
  callback(meter, 1e-4, 1000us, false);
  EXPECT_EQ(meter.read().misses, 0);
}

TEST(LoadMeter, ThePercentileLeavesOutOneInAHundredButNotTwo) {
  LoadMeter meter;
  for (int i = 0; i < 199; ++i) callback(meter, 1e-2, 0us);
  callback(meter, 1e-4, 1000us);
  EXPECT_LT(meter.read().p99, 1);
  for (int i = 0; i < 3; ++i) callback(meter, 1e-4, 1000us);
  EXPECT_GE(meter.read().p99, 10 / 1.04);
  EXPECT_LE(meter.read().p99, meter.read().peak);
}

}  // namespace
}  // namespace ringdown::server
