// The parts of `./run bench deadline`: each prints and keeps its figures through `Table::add`.
#pragma once

#include "protocol/reply.h"
#include "tests/integration/daemon_fixture.h"

#include <cstdio>
#include <optional>
#include <string>

namespace ringdown::bench {

// Lines of "part,case,run,figure,value,unit", to the terminal and into a file.
class Table {
 public:
  explicit Table(std::FILE* csv);
  void add(const std::string& part, const std::string& what, int run, const std::string& figure, double value,
           const std::string& unit);

 private:
  void line(const std::string& text);
  std::FILE* csv_;  // null: none
};

struct Extent {
  int runs;        // of each case
  double seconds;  // that a run of the load is measured for
  int servers;     // JACK servers one after the other
};
inline constexpr Extent kWhole{5, 3, 8}, kQuick{1, 1, 2};

// Late callbacks of a scene that takes some four times the time there is, without a budget and with one of 70 %; and of
// a small scene, which says how much the machine itself disturbs an audio thread.
void measure_load(const Extent& extent, Table& table);

// How far strikes are from when they should sound, against the first: bundles with time tags, and messages without.
void measure_times(const Extent& extent, Table& table);

// How soon the daemon plays at a JACK server that comes after another one was killed.
void measure_reconnection(const Extent& extent, Table& table);

// Nothing when the daemon does not answer.
std::optional<protocol::StatusReply> status(test::Daemon& daemon);
wire::Message strike(const std::string& object, double impulse_ns);

// Starts the server again when it has not come up, a few times; real-time scheduling does not always start at once.
// Ends the program with a sentence when none comes up.
void need(test::JackServer& server, int sample_rate_hz, int period_frames);

}  // namespace ringdown::bench
