// The whole way with real parts: jackd, ringdownd, oscsend, and a JACK client that records.
#include "engine/modal/bank_file.h"
#include "tests/integration/jack_clock.h"
#include "tests/integration/jack_fixture.h"
#include "tests/support/keep_signals.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <thread>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

constexpr double kRate = 48000;
constexpr int kMaxRecordings = 15;  // a virtual machine spoils up to every second one
constexpr double kEven_s = 5e-4;

// Frames at which the signal exceeds `threshold` after staying below it for more than `quiet` frames.
std::vector<std::size_t> onsets(const Samples& samples, double threshold, std::size_t quiet) {
  std::vector<std::size_t> found;
  std::size_t last_loud = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (std::abs(samples[n]) <= threshold) continue;
    if (found.empty() || n - last_loud > quiet) found.push_back(n);
    last_loud = n;
  }
  return found;
}

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Ten bundles ahead of their time, then ten messages; when each should sound with a latency of 0.2 s.
// Nothing when this thread was kept from running: it then cannot say when it sent.
std::vector<double> play_twenty(Daemon& daemon, const std::string& object) {
  const wire::Message strike = protocol::format(protocol::Strike{{.name = object}, {1, 0, 0}, {0, 0, 1}, 0});
  std::vector<double> meant;
  const double start = unix_now_s() + 0.2;
  for (int i = 0; i < 10; ++i) {
    meant.push_back(start + 0.0801 * i + 1e-5 * i * i);
    daemon.send_bundle(meant.back(), {strike});
  }
  std::this_thread::sleep_for(900ms);
  for (int i = 0; i < 10; ++i) {
    meant.push_back(unix_now_s() + 0.2);
    daemon.send(strike);
    if (unix_now_s() - (meant.back() - 0.2) > 3e-4) return {};
    std::this_thread::sleep_for(61ms);
  }
  return meant;
}

class Jack : public JackTest {
 protected:
  // The first recording during which the server's own clock ran evenly and without an xrun: in others frames are
  // missing or times are off whatever the daemon does. What was heard in it then counts, good or bad. Nothing when
  // there was none, or when `play` says each time that it could not play as it should; a failure, if the machine was
  // not to blame for most of them.
  std::optional<Samples> record_undisturbed(double seconds, const std::function<bool()>& play) {
    JackClock clock(server_.name());
    EXPECT_TRUE(clock.works());
    int disturbed = 0;
    for (int tries = 0; tries < kMaxRecordings; ++tries) {
      bool played = false;
      clock.restart();
      Samples heard = record(seconds, [&] { played = play(); });
      const bool quiet = played && clock.strayed_s() <= kEven_s;
      if (quiet && clock.xruns() == 0) return heard;
      disturbed += quiet ? 0 : 1;
    }
    EXPECT_GT(2 * disturbed, kMaxRecordings) << "xruns, while the server's clock runs evenly: a client is late";
    return std::nullopt;
  }
};

#define SKIP_IF_DISTURBED(heard) \
  if (HasFailure()) return;      \
  if (!(heard)) GTEST_SKIP() << "the machine is too busy: jackd was late in most of " << kMaxRecordings << " recordings"

TEST_F(Jack, AStrikeFromOscsendIsRecordedAtItsPitchAndDecay) {
  Daemon daemon({"--object", "tone=" + bank_.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const Samples heard = record(2, [&] {
    const auto sent = run({"oscsend", "osc.udp://127.0.0.1:" + std::to_string(daemon.port()), "/object/tone/strike",
                           "fffffff", "1", "0", "0", "0", "0", "0.5", "0"});
    EXPECT_EQ(sent.exit_code, 0) << sent.output;
  });
  KeepSignals keep(kRate);
  keep.add("heard", heard);
  ASSERT_GT(heard.size(), 90000u);

  const auto begin = onsets(heard, 1e-4, 90000);
  ASSERT_EQ(begin.size(), 1u);
  EXPECT_EQ(peak(std::span(heard).first(begin.front() - 2)), 0) << "silence before the strike";
  const auto tone = fit_damped_sinusoid(std::span(heard).subspan(begin.front(), 24000), kRate);
  EXPECT_NEAR(tone.frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
  EXPECT_NEAR(tone.decay_per_s, kDecay_per_s, 1e-2 * kDecay_per_s);
  EXPECT_GT(tone.amplitude(), 0.01);
}

TEST_F(Jack, TimedBundlesKeepTheirDistanceToAMillisecond) {
  Daemon daemon({"--object", "tone=" + bank_.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const wire::Message strike = protocol::format(protocol::Strike{{.name = "tone"}, {1, 0, 0}, {0, 0, 0.5}, 0});
  const wire::Message clear = protocol::format(protocol::ClearAll{});
  constexpr double kApart_s = 0.3137;
  const auto heard = record_undisturbed(2, [&] {
    const double now = unix_now_s();
    daemon.send_bundle(now + 0.2, {strike});
    daemon.send_bundle(now + 0.3, {clear});  // so that the second onset rises out of silence
    daemon.send_bundle(now + 0.2 + kApart_s, {strike});
    daemon.send_bundle(now + 0.8, {clear});  // and the next recording begins in it
    return true;
  });
  SKIP_IF_DISTURBED(heard);
  KeepSignals keep(kRate);
  keep.add("heard", *heard);
  const auto found = onsets(*heard, 1e-4, 8000);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(static_cast<double>(found[1] - found[0]) / kRate, kApart_s, 1e-3);
}

// Bundles anywhere in a block, and messages sent at any time: both keep their distances.
TEST_F(Jack, TwentyStrikesKeepTheirTimes) {
  const auto tick = folder_ / "tick.glb";
  ASSERT_TRUE(modal::write_bank(single_mode_bank(6000, 800), tick));  // silent after 20 ms
  Daemon daemon({"--object", "tick=" + tick.string(), "--latency", "200ms"}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  std::vector<double> meant;
  const auto heard = record_undisturbed(4, [&] {
    meant = play_twenty(daemon, "tick");
    return !meant.empty();
  });
  SKIP_IF_DISTURBED(heard);
  KeepSignals keep(kRate);
  keep.add("heard", *heard);
  const auto found = onsets(*heard, 1e-4, 960);
  ASSERT_EQ(found.size(), meant.size());
  double worst_s = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double error_s = static_cast<double>(found[i] - found[0]) / kRate - (meant[i] - meant[0]);
    worst_s = std::max(worst_s, std::abs(error_s));
  }
  std::printf("worst error of 10 bundles and 10 messages: %.3f ms\n", 1000 * worst_s);
  EXPECT_LE(worst_s, 1e-3);
}

TEST_F(Jack, ItsPortsAreNamedAndItStopsCleanlyOnASignal) {
  Daemon daemon({}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const Outcome ports = run({"jack_lsp"}, server_.environment());
  EXPECT_NE(ports.output.find("ringdown:out_left"), std::string::npos) << ports.output;
  EXPECT_NE(ports.output.find("ringdown:out_right"), std::string::npos) << ports.output;
  daemon.process().send_signal(SIGINT);
  EXPECT_EQ(daemon.process().wait(10s), 0) << daemon.process().output();
  EXPECT_EQ(run({"jack_lsp"}, server_.environment()).output.find("ringdown:"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::test
