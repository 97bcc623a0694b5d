#include "engine/modal/bank_file.h"
#include "tests/bench/deadline/parts.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <array>
#include <chrono>
#include <csignal>

namespace ringdown::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Format {
  int rate, period;
};
constexpr std::array<Format, 4> kServers = {{{44100, 512}, {96000, 1024}, {48000, 256}, {44100, 256}}};

}  // namespace

void measure_reconnection(const Extent& extent, Table& table) {
  const test::TemporaryFolder folder;
  const auto tone = folder / "tone.glb";
  static_cast<void>(modal::write_bank(test::single_mode_bank(440, 1), tone));
  test::JackServer server(48000, 256, test::JackServer::Mode::realtime);
  need(server, 48000, 256);
  test::Daemon daemon({"--object", "tone=" + tone.string()}, server.environment());
  for (int n = 0; daemon.ready() && n < extent.servers; ++n) {
    const Format& next = kServers[static_cast<std::size_t>(n) % kServers.size()];
    server.stop(SIGKILL);
    server.start(next.rate, next.period);
    need(server, next.rate, next.period);
    const auto begin = Clock::now();
    const bool met = test::becomes_true([&] { return server.connections().contains("ringdown:out_left"); });
    const double took_ms = 1000 * std::chrono::duration<double>(Clock::now() - begin).count();
    if (!met) {
      std::fprintf(stderr, "reconnection: a server was not met again\n");
      return;
    }
    table.add("reconnection", std::to_string(next.rate) + " Hz; blocks of " + std::to_string(next.period), n,
              "ports are back after", took_ms, "ms");
  }
}

}  // namespace ringdown::bench
