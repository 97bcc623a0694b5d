// Figures of the daemon by the wall clock: a real jackd with real-time scheduling, a real ringdownd.
//
//   ringdown_deadline_bench [--quick] [--only PART] [-o FILE]
//
// They depend on the machine and on what else it does, so nothing is held against them; what they rest on is tested by
// clocks that tests set (tests/synth, tests/server).
#include "tests/bench/deadline/parts.h"

#include <CLI/CLI.hpp>

#include <cstdlib>
#include <map>

namespace ringdown::bench {

Table::Table(std::FILE* csv) : csv_(csv) { line("part,case,run,figure,value,unit"); }

void Table::add(const std::string& part, const std::string& what, int run, const std::string& figure, double value,
                const std::string& unit) {
  char number[32];
  std::snprintf(number, sizeof number, "%.4g", value);
  line(part + "," + what + "," + std::to_string(run) + ",\"" + figure + "\"," + number + "," + unit);
}

void Table::line(const std::string& text) {
  for (std::FILE* const to : {stdout, csv_}) {
    if (!to) continue;
    std::fprintf(to, "%s\n", text.c_str());
    std::fflush(to);
  }
}

std::optional<protocol::StatusReply> status(test::Daemon& daemon) {
  daemon.send({"/status", {}});
  const auto reply = daemon.reply(std::chrono::seconds(5));
  const auto* status = reply ? reply->get_if<protocol::StatusReply>() : nullptr;
  return status ? std::optional(*status) : std::nullopt;
}

wire::Message strike(const std::string& object, double impulse_ns) {
  return protocol::format(protocol::Strike{{.name = object}, {{1, 0, 0}, {0, 0, impulse_ns}, 0}});
}

void need(test::JackServer& server, int sample_rate_hz, int period_frames) {
  for (int tries = 0; !server.runs(); ++tries) {
    if (!test::installed("jackd") || tries == 2) {
      std::fprintf(stderr, "no JACK server with real-time scheduling starts here (jackd2, and the right to it)\n");
      std::exit(1);
    }
    server.stop();
    server.start(sample_rate_hz, period_frames);
  }
}

}  // namespace ringdown::bench

int main(int count, char** words) {
  using namespace ringdown::bench;
  bool quick = false;
  std::string path, only;
  const std::map<std::string, void (*)(const Extent&, Table&)> parts = {
      {"load", measure_load}, {"times", measure_times}, {"reconnection", measure_reconnection}};
  CLI::App app("Figures of the daemon by the wall clock", "ringdown_deadline_bench");
  app.add_flag("--quick", quick, "One run of each, and shorter");
  app.add_option("--only", only, "One part: load, times or reconnection")->check(CLI::IsMember(parts));
  app.add_option("-o", path, "CSV file");
  CLI11_PARSE(app, count, words);
  std::FILE* const csv = path.empty() ? nullptr : std::fopen(path.c_str(), "w");
  if (!path.empty() && !csv) {
    std::fprintf(stderr, "cannot write %s\n", path.c_str());
    return 3;
  }
  Table table(csv);
  for (const auto& [name, measure] : parts) {
    if (only.empty() || only == name) measure(quick ? kQuick : kWhole, table);
  }
  if (csv) std::fclose(csv);
}
