// The meter of the audio callback, by a clock that the test sets; and what it says of a mixer that has too much to do.
#include "server/load_meter.h"

#include "tests/synth/fake_clock.h"
#include "tests/synth/player.h"

#include <gtest/gtest.h>

namespace ringdown::server {
namespace {

using synth::test::fake_now_ns;

constexpr double kPeriod_s = 1e-3;

// The clock of the mixer's own tests: it moves when a test says so, and when the mixer has worked.
LoadMeter::Clock::time_point fake_now() REALTIME {
  return LoadMeter::Clock::time_point(std::chrono::nanoseconds(fake_now_ns));
}

void pass(double seconds) { fake_now_ns += static_cast<std::int64_t>(1e9 * seconds); }

// A callback of 1 ms that uses `load` of its time.
void callback(LoadMeter& meter, double load, bool deadline = true) {
  meter.begin(48, 48000);
  pass(load * kPeriod_s);
  meter.end(deadline);
}

TEST(LoadMeter, ACallbackLongerThanItsPeriodIsAMissAndItsXrunOurs) {
  LoadMeter meter(fake_now);
  for (int i = 0; i < 10; ++i) callback(meter, 0.99);
  meter.note_xrun();
  EXPECT_EQ(meter.read().misses, 0);
  EXPECT_EQ(meter.read().xruns, 1);
  EXPECT_EQ(meter.read().own_xruns, 0) << "somebody else's";
  callback(meter, 1.01);
  meter.note_xrun();
  EXPECT_EQ(meter.read().misses, 1);
  EXPECT_EQ(meter.read().own_xruns, 1);
  meter.note_xrun();
  EXPECT_EQ(meter.read().xruns, 3);
  EXPECT_EQ(meter.read().own_xruns, 1) << "one miss explains one xrun";
  EXPECT_NEAR(meter.read().peak, 1.01, 1e-6);
}

TEST(LoadMeter, AServerThatStopsCallingIsAnXrunAndALossButNotOurs) {
  LoadMeter meter(fake_now);
  callback(meter, 0.5);
  meter.note_stall(1.25);
  EXPECT_EQ(meter.read().xruns, 1);
  EXPECT_EQ(meter.read().own_xruns, 0);
  EXPECT_EQ(meter.read().misses, 0);
  EXPECT_EQ(meter.read().skipped_s, 1.25);
}

TEST(LoadMeter, AnXrunIsOursWhileTheLateCallbackStillRuns) {
  LoadMeter meter(fake_now);
  meter.begin(48, 48000);
  pass(0.9 * kPeriod_s);
  meter.note_xrun();
  EXPECT_EQ(meter.read().own_xruns, 0) << "it is not late yet";
  pass(0.2 * kPeriod_s);
  meter.note_xrun();
  meter.end();
  meter.note_xrun();
  EXPECT_EQ(meter.read().xruns, 3);
  EXPECT_EQ(meter.read().own_xruns, 1);
}

TEST(LoadMeter, NoCallbackIsAMissInFreewheel) {
  LoadMeter meter(fake_now);
  callback(meter, 10, false);
  EXPECT_EQ(meter.read().misses, 0);
}

TEST(LoadMeter, TheMeanLoadIsOfASecond) {
  LoadMeter meter(fake_now);
  for (int i = 0; i < 20000; ++i) callback(meter, 0.25);
  EXPECT_NEAR(meter.read().mean, 0.25, 1e-3);
  for (int i = 0; i < 1000; ++i) callback(meter, 0.75);
  EXPECT_NEAR(meter.read().mean, 0.75 - 0.5 * std::exp(-1), 1e-3);
}

TEST(LoadMeter, ThePercentileOfLoadsLeavesOutOneInAHundredButNotTwo) {
  LoadMeter meter(fake_now);
  for (int i = 0; i < 198; ++i) callback(meter, 0.5);
  callback(meter, 10);
  callback(meter, 10);
  EXPECT_NEAR(meter.read().p99, 0.5, 0.04 * 0.5);
  for (int i = 0; i < 3; ++i) callback(meter, 10);
  EXPECT_GE(meter.read().p99, 10 / 1.04);
  EXPECT_LE(meter.read().p99, meter.read().peak);
}

TEST(LoadMeter, ThePercentileOfLoadsForgetsWhatIsTenSecondsAgo) {
  LoadMeter meter(fake_now);
  for (int i = 0; i < 1000; ++i) callback(meter, 10);
  EXPECT_GT(meter.read().p99, 9);
  for (int i = 0; i < 10100; ++i) callback(meter, 0.5);
  EXPECT_LT(meter.read().p99, 0.53);
  EXPECT_NEAR(meter.read().peak, 10, 1e-6) << "the peak is of all time";
}

// As the JACK driver does it, with a scene that takes four times the time there is.
struct Callbacks {
  int misses, own_xruns;
  std::uint32_t sounding, muted;
};

Callbacks play_too_much(double share) {
  constexpr std::size_t kFrames = 128;
  constexpr int kBlocks = 600;
  constexpr synth::ObjectNumber kObjects = 40;
  constexpr std::size_t kModes = 500;
  synth::test::Player player;
  synth::Mixer& mixer = player.mixer;
  synth::test::set(mixer, &synth::MixerSettings::clock, synth::test::kFake);
  synth::test::fake_unit_ns = 0;
  for (synth::ObjectNumber object = 0; object < kObjects; ++object) {
    player.install(object, synth::test::map_of(test::random_bank(object, kModes, 10)));
    player.push(synth::test::strike_at(0, object, {0, 0.03 * std::pow(10.0, -0.05 * object), 0}));
  }
  player.render(kFrames, kFrames);
  synth::test::set(mixer, &synth::MixerSettings::budget, share);
  synth::test::fake_unit_ns = 4 * kFrames * 1e9 / synth::test::kRate / (kObjects * kModes);
  player.render(kFrames, kFrames);  // in which the mixer learns what its work costs
  LoadMeter meter(fake_now);
  for (int block = 0; block < kBlocks; ++block) {
    const int before = meter.read().misses;
    meter.begin(kFrames, synth::test::kRate);
    player.render(kFrames, kFrames);
    meter.end();
    if (meter.read().misses > before) meter.note_xrun();  // the server waits for what is late
  }
  const Driver::Load load = meter.read();
  return {load.misses, load.own_xruns, mixer.counters().ringing_modes.load(), mixer.counters().muted_modes.load()};
}

TEST(LoadMeter, EveryBlockOfAnUnboundedMixerIsAMissAndNoneOfABoundedOne) {
  const Callbacks without = play_too_much(0), with = play_too_much(0.7);
  EXPECT_GT(without.misses, 500);
  EXPECT_EQ(without.own_xruns, without.misses);
  EXPECT_EQ(with.misses, 0);
  EXPECT_EQ(with.own_xruns, 0);
  EXPECT_GT(with.sounding, 1000u);
  EXPECT_GT(with.muted, 0u);
}

}  // namespace
}  // namespace ringdown::server
