// The pairing of two clocks against clocks whose truth is known.
#include "server/frame_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ringdown::server {
namespace {

constexpr double kRate = 48000;

// A computer's clock that moves only when told, and an audio clock that runs `drift` fast and started at `start_s`.
struct TestClocks {
  double now_s = 1000, start_s = 990, drift = 0;
  double torn_s = 0;  // the scheduler takes so long between two readings
  std::mt19937 random{7};
  double jitter_frames = 0;

  [[nodiscard]] double true_frame(double time_s) const { return (time_s - start_s) * kRate * (1 + drift); }
  FrameClock clock() {
    return {{[this] {
               now_s += torn_s;
               std::normal_distribution<double> noise(0, 1);
               return static_cast<synth::Frame>(std::floor(true_frame(now_s) + jitter_frames * noise(random)));
             },
             [] { return kRate; }},
            [this] { return now_s; }};
  }
};

void run(FrameClock& clock, TestClocks& clocks, double seconds) {
  for (const double end = clocks.now_s + seconds; clocks.now_s < end; clocks.now_s += 0.05) clock.measure();
}

TEST(FrameClock, TheFrameOfAnyTimeIsFoundToHalfASample) {
  TestClocks clocks;
  FrameClock clock = clocks.clock();
  run(clock, clocks, 2);
  for (const double ahead_s : {-1., 0., 0.1234, 5.}) {
    EXPECT_NEAR(static_cast<double>(clock.frame_at(clocks.now_s + ahead_s)), clocks.true_frame(clocks.now_s + ahead_s),
                1.01);
  }
  EXPECT_NEAR(clock.time_of(clock.frame_at(clocks.now_s)), clocks.now_s, 1.01 / kRate);
}

// 200 ppm is more than two crystals differ by. The average lags by 0.5 s: 5 samples.
TEST(FrameClock, TheFrameClockFollowsADriftingClockAndAveragesItsJitter) {
  TestClocks clocks;
  clocks.drift = 200e-6;
  clocks.jitter_frames = 20;
  FrameClock clock = clocks.clock();
  run(clock, clocks, 10);
  for (int i = 0; i < 100; ++i) {
    run(clock, clocks, 0.1);
    EXPECT_NEAR(static_cast<double>(clock.frame_at(clocks.now_s)), clocks.true_frame(clocks.now_s), 5 + 24);
  }
}

TEST(FrameClock, AReadingOfClocksTornByTheSchedulerIsNotBelieved) {
  TestClocks clocks;
  FrameClock clock = clocks.clock();
  run(clock, clocks, 2);
  clocks.torn_s = 0.03;
  clocks.now_s += 0.1;
  clock.measure();
  clocks.torn_s = 0;
  EXPECT_NEAR(static_cast<double>(clock.frame_at(clocks.now_s)), clocks.true_frame(clocks.now_s), 1.01);
}

TEST(FrameClock, AJumpOfTheAudioClockThatStaysIsBelieved) {
  TestClocks clocks;
  FrameClock clock = clocks.clock();
  run(clock, clocks, 2);
  clocks.start_s += 0.5;  // an xrun of half a second
  run(clock, clocks, 0.3);
  EXPECT_NEAR(static_cast<double>(clock.frame_at(clocks.now_s)), clocks.true_frame(clocks.now_s), 1.01);
}

}  // namespace
}  // namespace ringdown::server
