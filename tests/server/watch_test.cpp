// Modes by themselves, and what subscribers can watch: the sound and the modes' amplitudes.
#include "protocol/wire/message.h"
#include "protocol/wire/score.h"
#include "server/session/offline.h"
#include "server/session/state.h"
#include "tests/server/osc_server_fixture.h"
#include "tests/support/signal.h"

#include <algorithm>

namespace ringdown::server {
namespace {

// 40 modes; the bank's own order is not by frequency.
class WatchTest : public OscServerTest {
 protected:
  WatchTest() {
    EXPECT_TRUE(modal::write_bank(bank_, folder_ / "bell.glb"));
    EXPECT_TRUE(session_.rack().load("bell", folder_ / "bell.glb"));
    std::ranges::sort(pitches_);
  }

  test::Samples render(std::size_t frames) {
    test::Samples samples;
    for (std::size_t done = 0; done < frames; done += kBlock) {
      std::vector<float> left(kBlock), right(kBlock);
      session_.rack().mixer().render(left, right);
      samples.insert(samples.end(), left.begin(), left.end());
    }
    return samples;
  }
  // To when an untimed message that was sent before has happened.
  void catch_up() {
    sync();
    onsets_until(driver_.now() + latency_frames(driver_) + static_cast<Frame>(kBlock));
  }
  protocol::ObjectReply described() {
    send({"/object/bell/describe", {}});
    const auto answer = reply();
    return answer ? answer->get<protocol::ObjectReply>() : protocol::ObjectReply{};
  }
  // Notices may come before the answer.
  bool done(const Message& message) {
    send(message);
    while (const auto answer = reply()) {
      if (answer->holds<protocol::Done>()) return true;
      if (answer->holds<protocol::Fail>()) return false;
    }
    return false;
  }

  modal::Bank bank_ = test::random_bank(2, 40, 12);
  std::vector<double> pitches_ = bank_.frequency_hz;
};

TEST_F(WatchTest, ARungModeHasTheFrequencyOfItsRank) {
  serve();
  send({"/object/bell/ring", {20, 1, 0.25f}});
  catch_up();
  EXPECT_NEAR(test::fit_damped_sinusoid(render(4096), kRate).frequency_hz, pitches_[20], 0.1);
  EXPECT_NE(refusal({"/object/bell/ring", {40}}).find("has 40"), std::string::npos);
  EXPECT_NE(refusal({"/object/bowl/ring", {0}}).find("bowl"), std::string::npos);
}

TEST_F(WatchTest, AChoiceOfModesStaysUntilTheObjectGetsANewBank) {
  serve();
  EXPECT_EQ(described().selected_modes, 40);
  ASSERT_TRUE(done({"/object/bell/modes", {35, 20}}));
  EXPECT_EQ(described().first_mode, 35);
  EXPECT_EQ(described().selected_modes, 5);
  ASSERT_TRUE(done({"/object/bell/modes", {3, 1}}));
  ASSERT_TRUE(done({"/object/bell/material", {1, 1, 1, 4}}));
  ASSERT_TRUE(done({"/object/bell/hold", {0.f, 0.f, 0.f, 0.001f}}));
  EXPECT_EQ(described().first_mode, 3);
  session_.change_sample_rate(96000);
  session_.change_sample_rate(kRate);
  send({"/object/bell/ring", {0, 40, 0.25f}});
  catch_up();
  const auto heard = test::fit_damped_sinusoid(render(4096), kRate);
  EXPECT_NEAR(heard.frequency_hz, 2 * pitches_[3], 1) << "four times as stiff, twice as high";
  ASSERT_TRUE(done({"/load", {"bell", (folder_ / "bell.glb").string()}}));
  sync();
  EXPECT_EQ(described().selected_modes, 40);
}

TEST_F(WatchTest, ScoresAndStatesKeepTheChoiceAndWhatWasRung) {
  serve();
  ASSERT_TRUE(done({"/object/bell/modes", {5, 30}}));
  ASSERT_TRUE(done({"/record/start", {(folder_ / "a.osc").string()}}));
  const Frame begin = session_.rack().mixer().counters().frames;
  send({"/object/bell/ring", {10, 1, 0.5f}});
  catch_up();
  ASSERT_TRUE(done({"/object/bell/modes", {10, 1}}));
  render(9600);
  const Frame end = session_.rack().mixer().counters().frames;
  send({"/record/stop", {}});
  ASSERT_TRUE(reply());
  const auto again = session::render_offline(
      {.score = wire::read_score(folder_ / "a.osc").value(), .sample_rate_hz = kRate, .block_frames = kBlock},
      [](double) { return true; });
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(again->warnings.empty());
  ASSERT_GE(again->left.size(), static_cast<std::size_t>(end - begin));
  const auto tail = test::to_doubles(std::span(again->left).subspan(again->left.size() - 4800));
  EXPECT_NEAR(test::fit_damped_sinusoid(tail, kRate).frequency_hz, pitches_[10], 1);

  ASSERT_TRUE(done({"/state/save", {(folder_ / "s.toml").string()}}));
  const auto state = session::read_state(folder_ / "s.toml");
  ASSERT_TRUE(state) << state.error().message;
  ASSERT_EQ(state->objects.size(), 1u);
  EXPECT_EQ(state->objects[0].modes, (modal::ModeRange{10, 1}));
  session::Session other(kRate);
  ASSERT_TRUE(restore(*state, other, 0));
  EXPECT_EQ((*other.rack().find({.name = "bell"}))->modes, (modal::ModeRange{10, 1}));
}

TEST_F(WatchTest, OnlySubscribersWatch) {
  serve();
  EXPECT_NE(refusal({"/watch/sound", {1}}).find("/notify"), std::string::npos);
  EXPECT_NE(refusal({"/object/bell/watch", {1}}).find("/notify"), std::string::npos);
  ASSERT_TRUE(done({"/notify", {1, 0.1f}}));
}

TEST_F(WatchTest, TheSoundIsToldFrameByFrameThoughNoticesAreRare) {
  serve();
  send({"/notify", {1, 0.1f}});
  send({"/watch/sound", {1}});
  send({"/test_tone", {0.5f, 1000.f}});
  sync();
  const auto first = static_cast<std::int32_t>(session_.rack().mixer().counters().frames.load());
  const test::Samples wanted = render(4096);
  test::Samples heard;
  for (int i = 0; i < 1000 && heard.size() < wanted.size(); ++i) {
    for (const protocol::Reply& told : notice(client_)) {
      const auto* sound = told.get_if<protocol::NotifySound>();
      if (!sound) continue;
      EXPECT_EQ(sound->frame, first + static_cast<std::int32_t>(heard.size()));
      EXPECT_EQ(sound->sample_rate_hz, kRate);
      const std::vector<float> samples = wire::decode_floats(sound->samples);
      EXPECT_LE(samples.size(), 2 * protocol::kMaxSoundFrames);
      for (std::size_t n = 0; n < samples.size(); n += 2) heard.push_back(samples[n]);
    }
  }
  EXPECT_EQ(heard, wanted);
  EXPECT_NEAR(test::peak(wanted), 0.5, 1e-3);
  send({"/notify", {0}});
  sync();
  EXPECT_FALSE(session_.rack().mixer().sound_tap().watched());
}

TEST_F(WatchTest, WatchedModesAreToldByFrequencyUntilTheSubscriberGoes) {
  serve();
  send({"/notify", {1, 100.f}});
  send({"/object/bell/watch", {1}});
  sync();
  send({"/object/bell/ring", {7, 2, 0.5f}});
  catch_up();
  render(1024);
  const auto told = wait_for<protocol::NotifyModes>(client_, [](const auto& modes) {
    return std::ranges::any_of(wire::decode_floats(modes.amplitudes), [](float a) { return a > 0; });
  });
  ASSERT_TRUE(told);
  EXPECT_EQ(told->object, "bell");
  EXPECT_EQ(told->first, 0);
  const std::vector<float> amplitudes = wire::decode_floats(told->amplitudes);
  ASSERT_EQ(amplitudes.size(), 40u);
  for (std::size_t rank = 0; rank < 40; ++rank) {
    EXPECT_EQ(amplitudes[rank] > 0, rank == 7 || rank == 8) << rank;
  }
  EXPECT_LE(amplitudes[7], 0.5001);
  EXPECT_TRUE(session_.rack().mixer().meters().mode_watch.watches());
  send({"/notify", {0}});
  sync();
  EXPECT_FALSE(session_.rack().mixer().meters().mode_watch.watches());
}

// Amplitudes are written every 10 ms, at the end of a chunk: when exactly is known to no more than that.
TEST_F(WatchTest, WatchedAmplitudesFallAsTheBankSays) {
  constexpr double kDecay_per_s = 4, kWritten_s = synth::ModeWatch::kEvery_s + 128 / kRate;
  ASSERT_TRUE(modal::write_bank(test::single_mode_bank(1000, kDecay_per_s), folder_ / "slow.glb"));
  ASSERT_TRUE(session_.rack().load("slow", folder_ / "slow.glb"));
  serve();
  ASSERT_TRUE(done({"/notify", {1, 100.f}}));
  ASSERT_TRUE(done({"/object/slow/watch", {1}}));
  send({"/object/slow/ring", {0, 1, 0.5f}});
  catch_up();
  const auto amplitude = [&] {
    float told = 0;
    sync();
    for (int i = 0; i < 2; ++i) {  // the first may have been on its way
      wait_for<protocol::NotifyModes>(client_, [&told](const auto& modes) {
        told = wire::decode_floats(modes.amplitudes).front();
        return true;
      });
    }
    return told;
  };
  render(4096);
  const double before = amplitude();
  const auto frames = static_cast<double>(render(48128).size());
  const double after = amplitude();
  ASSERT_GT(after, 0);
  EXPECT_NEAR(std::log(before / after), kDecay_per_s * frames / kRate, kDecay_per_s * kWritten_s);
}

TEST_F(WatchTest, SixteenObjectsAreWatchedByAllTogether) {
  for (std::size_t i = 0; i <= synth::kMaxWatched; ++i) load("o" + std::to_string(i));
  serve();
  ASSERT_TRUE(done({"/notify", {1, 0.1f}}));
  const auto watch = [&](std::size_t i, std::int32_t on) {
    return done({"/object/o" + std::to_string(i) + "/watch", {on}});
  };
  for (std::size_t i = 0; i < synth::kMaxWatched; ++i) EXPECT_TRUE(watch(i, 1)) << i;
  EXPECT_FALSE(watch(synth::kMaxWatched, 1));
  EXPECT_TRUE(watch(0, 0));
  EXPECT_TRUE(watch(synth::kMaxWatched, 1));
  send({"/object/o1/free", {}});
  sync();
  EXPECT_TRUE(watch(0, 1)) << "an object that is freed is watched no more";
}

}  // namespace
}  // namespace ringdown::server
