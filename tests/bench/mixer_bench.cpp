// The mixer against other programs and against exact sums: how many modes, how far off, what else costs what.
//
//   ringdown_mixer_bench -o build/bench/mixer.csv [--gate] [--quick] [--only PART]
//
// `./run bench mixer` runs it; docs/how/benchmarks.md reads it. All of it runs on one core.
#include "engine/synth/kernels/mode_kernel.h"
#include "tests/bench/machine.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/promises.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

struct Part {
  const char* name;
  void (*measure)(const bench::Settings&, const bench::Sink&);
};
constexpr std::array kParts = {Part{"throughput", bench::measure_throughput},
                               Part{"accuracy", bench::measure_accuracy},
                               Part{"silence", bench::measure_silence},
                               Part{"strike", bench::measure_strikes},
                               Part{"storm", bench::measure_storm},
                               Part{"decay", bench::measure_decay},
                               Part{"tail", bench::measure_tail},
                               Part{"instances", bench::measure_instances},
                               Part{"directions", bench::measure_directions},
                               Part{"fields", bench::measure_fields},
                               Part{"two-way", bench::measure_two_way},
                               Part{"nonlinear", bench::measure_nonlinear},
                               Part{"library", bench::measure_library},
                               Part{"threads", bench::measure_threads},
                               Part{"budget", bench::measure_budget},
                               Part{"growth", bench::measure_growth}};

}  // namespace

int main(int argc, char** argv) {
  fs::path output = "mixer.csv";
  bench::Settings settings;
  std::vector<std::string> only;
  bool gate = false;
  CLI::App app("Measures the mixer against other programs and exact sums.", "ringdown_mixer_bench");
  app.add_option("-o,--output", output, "the CSV to write; what peers read and write lies beside it");
  app.add_flag("--gate", gate, "exit with 1 when a promise is missed");
  app.add_flag("--quick", settings.quick, "under a minute: fewer and shorter repeats, the same promises");
  app.add_option("--only", only,
                 "parts: throughput accuracy silence strike storm decay tail instances directions fields two-way "
                 "nonlinear library threads budget growth");
  CLI11_PARSE(app, argc, argv);

  const std::string machine = bench::this_machine(synth::kernel_target());
  bench::hold_to_cores(1);
  settings.folder = fs::absolute(output).parent_path() / (output.stem().string() + "-runs");
  std::error_code ignored;
  fs::create_directories(settings.folder, ignored);

  bench::Rows rows;
  const auto keep = [&rows](bench::Row row) {
    const bool between_seconds = row.part == "decay" && std::fmod(row.time_s, 1) != 0;
    if (!between_seconds) bench::show(row);
    rows.push_back(std::move(row));
  };
  for (const Part& part : kParts) {
    if (only.empty() || std::find(only.begin(), only.end(), part.name) != only.end()) part.measure(settings, keep);
  }
  const auto written = bench::write_csv(output, rows, machine);
  if (!written) return std::fprintf(stderr, "%s\n", written.error().message.c_str()), 1;
  const bool kept = bench::report(bench::promises(rows));
  std::printf("\n%s\n", output.c_str());
  return gate && !kept ? 1 : 0;
}
