#include "tests/bench/mixer/faust.h"
#include "tests/bench/mixer/kernels.h"
#include "tests/bench/mixer/klank.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::bench {
namespace {

constexpr double kKlankGuess = 20000;      // modes per core, to choose how long scsynth renders
constexpr std::size_t kManyModes = 10000;  // fewer take too little memory to tell it from the rest of a process

struct Effort {
  std::size_t repeats;
  double repeat_s;  // of rendering, of each candidate
  double klank_s;   // of each run of scsynth, about
  std::vector<int> vector_sizes;
};

Effort effort(bool quick) { return quick ? Effort{3, 0.03, 0.15, {16}} : Effort{15, 0.1, 0.6, {8, 16, 32}}; }

// One of those that take turns.
struct Candidate {
  Row row;
  BlockTimes times;
  std::function<void(Candidate&)> repeat;  // adds to `times`, or makes row.status say why not
  std::function<std::string()> complaint;  // at the end, empty when all was well
};

struct Peers {
  std::vector<FaustCode> faust;
  std::string faust_status = "ok", klank_status = "ok";
  double klank_bytes_per_mode = kNone;
};

Candidate timed(Row row, double repeat_s, std::function<void()> render, std::function<std::string()> complaint) {
  const auto repeat = [repeat_s, render = std::move(render)](Candidate& self) {
    time_repeat(render, repeat_s, self.times);
  };
  return {std::move(row), {}, repeat, std::move(complaint)};
}

Candidate ours(Row row, const Effort& effort) {
  double bytes_per_mode = 0;
  const std::shared_ptr<Stage> stage = ringing_stage({.modes = row.modes}, row.objects, row.block, &bytes_per_mode);
  if (row.modes >= kManyModes) row.bytes_per_mode = bytes_per_mode;
  const auto complaint = [stage, modes = row.modes]() -> std::string {
    if (stage->ringing_modes() == modes) return "";
    return "failed: only " + std::to_string(stage->ringing_modes()) + " modes rang to the end";
  };
  return timed(
      std::move(row), effort.repeat_s, [stage] { stage->render(); }, complaint);
}

Candidate plain(Row row, const Effort& effort) {
  const auto modes = sinusoids_of(bank_of({.modes = row.modes})->bank());
  const std::shared_ptr<Kernel> filters = kernel(row.who).make(modes);
  const auto out = std::make_shared<std::vector<double>>(row.block);
  const auto complaint = [out]() -> std::string {
    return std::isnormal(out->back()) ? "" : "failed: it gave no sound";
  };
  return timed(
      std::move(row), effort.repeat_s, [filters, out] { filters->render(*out); }, complaint);
}

Candidate faust(Row row, const FaustCode& code, const Effort& effort) {
  row.who = code.name();
  const auto banks = std::make_shared<FaustBanks>(code, row.modes, row.block);
  row.bytes_per_mode = banks->bytes_per_mode();
  const auto complaint = [banks]() -> std::string { return banks->rings() ? "" : "failed: it gave no sound"; };
  return timed(
      std::move(row), effort.repeat_s, [banks] { banks->render(); }, complaint);
}

// Each repeat is two runs of scsynth, with modes and without; the difference is theirs.
Candidate klank(Row row, double bytes_per_mode, const Settings& settings, const Effort& effort) {
  row.bytes_per_mode = bytes_per_mode;
  const double seconds = std::max(1.0, effort.klank_s * kKlankGuess / static_cast<double>(row.modes));
  const auto repeat = [folder = settings.folder, seconds](Candidate& self) {
    Row& r = self.row;
    const auto with = run_klank(r.modes, r.block, seconds, folder), without = run_klank(0, r.block, seconds, folder);
    if (!with || !without) {
      r.status = "failed: " + (with ? without : with).error().message;
      return;
    }
    const double blocks = seconds * kRate / static_cast<double>(r.block);
    self.times.repeats_s.push_back((with->processor_s - without->processor_s) / blocks);
  };
  return {std::move(row), {}, repeat, [] { return std::string(); }};
}

Row row_of(const char* who, std::size_t modes, std::size_t objects, std::size_t block) {
  return {.part = "throughput", .who = who, .modes = modes, .objects = objects, .block = block};
}

std::vector<Candidate> candidates(std::size_t modes, std::size_t block, const Peers& peers, const Settings& settings,
                                  const Effort& effort) {
  std::vector<Candidate> list;
  list.push_back(ours(row_of("ours", modes, 1, block), effort));
  list.push_back(ours(row_of("ours", modes, 10, block), effort));
  if (block > 128) return list;  // only ours gains by longer blocks
  for (const char* name : {"two-pole", "closed form"}) list.push_back(plain(row_of(name, modes, 1, block), effort));
  for (const FaustCode& code : peers.faust) list.push_back(faust(row_of("", modes, 1, block), code, effort));
  if (peers.klank_status == "ok")
    list.push_back(klank(row_of("klank", modes, 1, block), peers.klank_bytes_per_mode, settings, effort));
  return list;
}

void compare(std::vector<Candidate>& list) {
  for (Candidate& candidate : list) candidate.row.ratio = list[0].row.modes_per_core / candidate.row.modes_per_core;
}

void measure_case(std::vector<Candidate> list, std::size_t repeats, const Sink& sink) {
  for (std::size_t r = 0; r < repeats; ++r) {
    for (Candidate& candidate : list) {
      if (candidate.row.ok()) candidate.repeat(candidate);
    }
  }
  for (Candidate& candidate : list) {
    const std::string complaint = candidate.complaint();
    if (candidate.row.ok() && !complaint.empty()) candidate.row.status = complaint;
    if (candidate.row.ok()) fill_in(candidate.row, candidate.times);
  }
  compare(list);
  for (Candidate& candidate : list) sink(std::move(candidate.row));
}

// Asked for before this process grows: what Linux tells of a child's peak is never less than what its parent had.
double klank_bytes_per_mode(const Settings& settings) {
  constexpr std::size_t kModes = 50000;
  const auto with = run_klank(kModes, 128, 0.1, settings.folder), without = run_klank(0, 128, 0.1, settings.folder);
  return with && without ? (with->peak_bytes - without->peak_bytes) / static_cast<double>(kModes) : kNone;
}

Peers find_peers(const Settings& settings, const Effort& effort) {
  Peers peers;
  if (scsynth_installed()) {
    peers.klank_bytes_per_mode = klank_bytes_per_mode(settings);
  } else {
    peers.klank_status = "not installed";
  }
  if (!faust_installed()) return peers.faust_status = "not installed", peers;
  for (const int size : effort.vector_sizes) {
    auto code = FaustCode::compile(size, settings.folder);
    if (!code) return peers.faust_status = "failed: " + code.error().message, peers;
    peers.faust.push_back(*code);
  }
  return peers;
}

void tell_missing(const std::string& who, const std::string& status, const Sink& sink) {
  if (status != "ok") sink({.part = "throughput", .who = who, .status = status});
}

}  // namespace

void measure_throughput(const Settings& settings, const Sink& sink) {
  const Effort how = effort(settings.quick);
  const Peers peers = find_peers(settings, how);
  tell_missing("faust", peers.faust_status, sink);
  tell_missing("klank", peers.klank_status, sink);
  for (const std::size_t modes : {100, 1000, 10000}) {
    for (const std::size_t block : {64, 128, 256}) {
      measure_case(candidates(modes, block, peers, settings, how), how.repeats, sink);
    }
  }
}

}  // namespace ringdown::bench
