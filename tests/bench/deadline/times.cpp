#include "engine/modal/bank_file.h"
#include "tests/bench/deadline/jack_clock.h"
#include "tests/bench/deadline/parts.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

namespace ringdown::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kRate = 48000, kPeriod = 256, kStrikes = 10;
constexpr double kLatency_s = 0.2;

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Frames at which sound rises after at least 20 ms of silence.
std::vector<std::size_t> onsets(const test::Samples& samples) {
  std::vector<std::size_t> found;
  std::size_t last_loud = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (std::abs(samples[n]) <= 1e-4) continue;
    if (found.empty() || n - last_loud > 960) found.push_back(n);
    last_loud = n;
  }
  return found;
}

// Ten bundles ahead of their time, then ten messages; when each should sound.
std::vector<double> play(test::Daemon& daemon) {
  std::vector<double> meant;
  const double start = unix_now_s() + kLatency_s;
  for (int i = 0; i < kStrikes; ++i) {
    meant.push_back(start + 0.0801 * i + 1e-5 * i * i);
    daemon.send_bundle(meant.back(), {strike("tick", 1)});
  }
  std::this_thread::sleep_for(900ms);
  for (int i = 0; i < kStrikes; ++i) {
    meant.push_back(unix_now_s() + kLatency_s);
    daemon.send(strike("tick", 1));
    std::this_thread::sleep_for(61ms);
  }
  return meant;
}

// The largest error of strikes `from` and the nine after it, in milliseconds, against the very first.
double worst_ms(const std::vector<std::size_t>& found, const std::vector<double>& meant, std::size_t from) {
  double worst = 0;
  for (std::size_t i = from; i < from + kStrikes; ++i) {
    const double error_s = static_cast<double>(found[i] - found[0]) / kRate - (meant[i] - meant[0]);
    worst = std::max(worst, 1000 * std::abs(error_s));
  }
  return worst;
}

}  // namespace

void measure_times(const Extent& extent, Table& table) {
  const test::TemporaryFolder folder;
  const auto tick = folder / "tick.glb";
  static_cast<void>(modal::write_bank(test::single_mode_bank(6000, 800), tick));  // silent after 20 ms
  test::JackServer server(kRate, kPeriod, test::JackServer::Mode::realtime);
  need(server, kRate, kPeriod);
  test::Daemon daemon({"--object", "tick=" + tick.string(), "--latency", std::to_string(1000 * kLatency_s) + "ms"},
                      server.environment());
  JackClock clock(server.name());
  for (int run = 0; run < 2 * extent.runs; ++run) {
    test::JackRecorder recorder(server.name(), "recorder", 3 * kRate, test::JackRecorder::From::call);
    if (!daemon.ready() || !recorder.connect("ringdown:out_left", "recorder:in_1")) {
      std::fprintf(stderr, "times: the daemon does not play\n");
      return;
    }
    recorder.record();
    clock.restart();
    const auto meant = play(daemon);
    const bool recorded = recorder.wait_for(3 * kRate);
    const auto found = onsets(recorder.samples(0));
    const auto add = [&](const char* figure, double value, const char* unit) {
      table.add("times", "20 strikes", run, figure, value, unit);
    };
    add("strikes heard", recorded ? static_cast<double>(found.size()) : 0, "");
    if (found.size() == meant.size()) {
      add("worst error of bundles", worst_ms(found, meant, 0), "ms");
      add("worst error of messages", worst_ms(found, meant, kStrikes), "ms");
    }
    add("the server's clock strayed", 1000 * clock.strayed_s(), "ms");
    add("xruns", clock.xruns(), "");
  }
}

}  // namespace ringdown::bench
