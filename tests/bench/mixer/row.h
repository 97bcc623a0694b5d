// One line of what the mixer benchmark measured.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace ringdown::bench {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // not measured, or it means nothing here
inline constexpr double kRate = 48000;                                     // [Hz] of everything measured

struct Row {
  std::string part;          // throughput accuracy silence strike storm decay tail instances directions fields two-way
                             // nonlinear library threads budget growth
  std::string who = "ours";  // or a peer, a kernel, a state
  std::size_t modes = 0, objects = 0, block = 0;
  std::string status = "ok";      // "not installed", "failed: ..."
  double time_s = kNone;          // since the strike
  double count = kNone;           // growth: of what `who` names
  double modes_per_core = kNone;  // that would ring in real time on the whole of one core
  double mean_us = kNone;         // processor time of a block (strike: of a strike), median over repeats
  double p50_us = kNone, p99_us = kNone, max_us = kNone;  // wall time of single blocks
  double bytes_per_mode = kNone;
  double ratio = kNone;     // throughput: ours in one object over this; tail: this over loud;
                            // instances: this over shared; directions: standing over this; fields: this over stereo;
                            // two-way: share of a core; nonlinear: this over linear, or share of a core; library: this
                            // over the mixer by itself; threads: 1 thread over this; budget: this over moments
  double error_db = kNone;  // of the sum, relative to the closed form in extended precision

  [[nodiscard]] bool ok() const { return status == "ok"; }
};

using Rows = std::vector<Row>;
using Sink = std::function<void(Row)>;

// What all measurements need to know.
struct Settings {
  bool quick = false;
  std::filesystem::path folder;  // for what peers read and write
};

void show(const Row& row);
Result<void> write_csv(const std::filesystem::path& path, const Rows& rows, const std::string& machine);

}  // namespace ringdown::bench
