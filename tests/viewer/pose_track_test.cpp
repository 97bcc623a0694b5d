// Interpolated poses, and the display clock, against closed forms.
#include "clients/viewer/link/pose_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace ringdown::viewer {
namespace {

constexpr double kPi = std::numbers::pi;

Quaternion about_z(double angle) { return {0, 0, std::sin(angle / 2), std::cos(angle / 2)}; }

// Flies at (3, -2, 1) m/s and turns about z at 2.5 rad/s.
Pose flight(double time_s) { return {{3 * time_s, -2 * time_s, 1 + time_s}, about_z(2.5 * time_s)}; }

void expect_near(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_NEAR(a.position_m.x, b.position_m.x, tolerance);
  EXPECT_NEAR(a.position_m.y, b.position_m.y, tolerance);
  EXPECT_NEAR(a.position_m.z, b.position_m.z, tolerance);
  const double alike = a.rotation.x * b.rotation.x + a.rotation.y * b.rotation.y + a.rotation.z * b.rotation.z +
                       a.rotation.w * b.rotation.w;
  EXPECT_NEAR(std::abs(alike), 1, tolerance);  // q and -q are one rotation
}

TEST(PoseHistory, AnEmptyTrackHasNoPose) {
  EXPECT_FALSE(PoseHistory().pose_at(0));
  EXPECT_FALSE(PoseHistory().last_time_s());
}

TEST(PoseHistory, PosesAreExactAtTheTimesAdded) {
  PoseHistory track;
  for (int i = 0; i < 20; ++i) track.add(i / 30.0, flight(i / 30.0));
  for (int i = 0; i < 20; ++i) expect_near(*track.pose_at(i / 30.0), flight(i / 30.0), 1e-12);
}

TEST(PoseHistory, PosesAreExactForConstantVelocityWhateverTheirSpacing) {
  PoseHistory track;
  for (const double t : {0.0, 0.03, 0.035, 0.2, 0.7}) track.add(t, flight(t));
  for (double t = 0; t <= 0.7; t += 0.01) expect_near(*track.pose_at(t), flight(t), 1e-12);
}

TEST(PoseHistory, PosesTurnTheShortestWayWhateverTheSignOfTheQuaternion) {
  Quaternion opposite = about_z(0.4);
  opposite = {-opposite.x, -opposite.y, -opposite.z, -opposite.w};
  expect_near(between({{}, about_z(0)}, {{}, opposite}, 0.5), {{}, about_z(0.2)}, 1e-12);
  expect_near(between({{}, about_z(0.9 * kPi)}, {{}, about_z(-0.9 * kPi)}, 0.5), {{}, about_z(kPi)}, 1e-12);
}

TEST(PoseHistory, BeforeTheFirstAndAfterTheLastPoseTheTrackStands) {
  PoseHistory track;
  track.add(1, flight(1));
  track.add(2, flight(2));
  expect_near(*track.pose_at(-5), flight(1), 1e-12);
  expect_near(*track.pose_at(9), flight(2), 1e-12);
}

TEST(PoseHistory, LateAndInvalidPosesAreIgnored) {
  PoseHistory track;
  track.add(1, flight(1));
  track.add(0.5, flight(7));
  track.add(2, {{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {}});
  track.add(2, {{}, {0, 0, 0, 0}});
  track.add(std::numeric_limits<double>::infinity(), flight(3));
  EXPECT_EQ(track.last_time_s(), 1);
  expect_near(*track.pose_at(0.5), flight(1), 1e-12);
}

TEST(PoseHistory, APoseForTheSameTimeReplacesTheFirst) {
  PoseHistory track;
  track.add(1, flight(1));
  track.add(1, flight(4));
  expect_near(*track.pose_at(1), flight(4), 1e-12);
}

TEST(PoseHistory, ATrackKeepsNoMorePosesThanItsBound) {
  PoseHistory track;
  for (std::size_t i = 0; i <= PoseHistory::kMaxPoses; ++i) track.add(static_cast<double>(i), flight(1.0 * i));
  expect_near(*track.pose_at(0), flight(1), 1e-12);  // the first is gone
  expect_near(*track.pose_at(1), flight(1), 1e-12);
}

TEST(DisplayClock, DisplayRunsOneAndAHalfPeriodsLate) {
  DisplayClock clock(0.04);
  for (int i = 0; i <= 50; ++i) clock.observe(100 + 0.04 * i, 7 + 0.04 * i, false);
  EXPECT_NEAR(*clock.time_at(102), 9 - 0.06, 1e-12);
}

TEST(DisplayClock, DisplayRunsEvenlyThoughNoticesArriveUnevenly) {
  constexpr double kPeriod_s = 1 / 30.0, kFrame_s = 1 / 60.0;
  DisplayClock clock(kPeriod_s);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> delay(0, 0.9 * kPeriod_s);
  int notice = 0;
  double arrival = 0, before = -1, worst = 0;
  for (int frame = 0; frame < 1200; ++frame) {
    const double now = frame * kFrame_s;
    for (; arrival <= now; arrival = notice * kPeriod_s + delay(random)) {
      clock.observe(now, notice * kPeriod_s, false);  // taken at the next frame
      ++notice;
    }
    const double shown = *clock.time_at(now);
    if (frame > 120) {
      worst = std::max(worst, std::abs(shown - before - kFrame_s));
      EXPECT_LE(shown, (notice - 1) * kPeriod_s);
      EXPECT_GE(shown, now - 5 * kPeriod_s);
    }
    before = shown;
  }
  EXPECT_LE(worst, 0.11 * kFrame_s);
}

TEST(DisplayClock, DisplayNeverGoesBackNorPastTheLastNotice) {
  DisplayClock clock(0.05);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> chance(0, 1);
  double now = 0, time = 0, shown = -1e9;
  for (int i = 0; i < 5000; ++i) {
    const double step = 0.1 * chance(random);
    now += step;
    time += step * (i / 1000 % 2 == 0 ? 1 : 0.6);  // every other while it is slowed down
    if (chance(random) < 0.5) clock.observe(now, time, i % 500 > 450);
    const auto next = clock.time_at(now);
    if (!next) continue;
    ASSERT_GE(*next, shown);
    ASSERT_LE(*next, time + 1e-12);
    shown = *next;
  }
}

TEST(DisplayClock, DisplayStandsAtThePausedTimeAndContinuesFromThere) {
  DisplayClock clock(0.04);
  double now = 0, time = 0;
  for (; now < 2; now += 0.04, time += 0.04) clock.observe(now, time, false), clock.time_at(now);
  time -= 0.04;
  for (int i = 0; i < 100; ++i, now += 0.04) clock.observe(now, time, true), clock.time_at(now);
  EXPECT_DOUBLE_EQ(*clock.time_at(now), time);
  const double stood = *clock.time_at(now);
  for (int i = 0; i < 100; ++i, now += 0.04, time += 0.04) {
    clock.observe(now, time, false);
    EXPECT_GE(*clock.time_at(now), stood);
  }
  EXPECT_NEAR(*clock.time_at(now), time - 0.06, 1e-9);  // as late as before the pause
}

TEST(DisplayClock, DisplayFollowsASceneThatIsSlowedDown) {
  DisplayClock clock(0.04);
  double now = 0, time = 0;
  for (int i = 0; i < 500; ++i, now += 0.04, time += 0.02) {
    clock.observe(now, time, false);
    clock.time_at(now);
  }
  EXPECT_NEAR(*clock.time_at(now), time, 0.2);
}

TEST(DisplayClock, DisplayRestartsWhenSceneTimeJumps) {
  DisplayClock clock(0.04);
  for (int i = 0; i <= 100; ++i) clock.observe(0.04 * i, 50 + 0.04 * i, false);
  ASSERT_GT(*clock.time_at(4), 50);
  EXPECT_EQ(clock.observe(4.04, 0.01, false), DisplayClock::Course::jumped);
  EXPECT_LE(*clock.time_at(4.05), 0.01);
  EXPECT_EQ(clock.observe(4.08, 30, false), DisplayClock::Course::jumped);
  EXPECT_NEAR(*clock.time_at(4.08), 30 - 0.06, 1e-9);
}

TEST(DisplayClock, ANoticeThatWasOvertakenIsLate) {
  DisplayClock clock(0.04);
  EXPECT_EQ(clock.observe(1, 10, false), DisplayClock::Course::onward);
  EXPECT_EQ(clock.observe(1.001, 9.96, false), DisplayClock::Course::late);
  EXPECT_EQ(clock.observe(1.04, 10.04, false), DisplayClock::Course::onward);
}

}  // namespace
}  // namespace ringdown::viewer
