#include "tests/bench/mixer/klank.h"

#include "engine/base/process/child_process.h"
#include "tests/bench/mixer/row.h"
#include "tests/bench/mixer/supercollider_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kLimit_s = 300;

// The last samples it wrote: raw floats of one channel.
bool rings(const fs::path& sound) {
  std::array<float, 256> tail{};
  std::ifstream file(sound, std::ios::binary);
  file.seekg(-static_cast<std::streamoff>(sizeof tail), std::ios::end);
  if (!file.read(reinterpret_cast<char*>(tail.data()), sizeof tail)) return false;
  return std::all_of(tail.begin(), tail.end(), [](float x) { return std::isfinite(x); }) &&
         std::any_of(tail.begin(), tail.end(), [](float x) { return std::abs(x) > 1e-6f; });
}

}  // namespace

bool scsynth_installed() { return run_child({.command = {"scsynth", "-v"}}).has_value(); }

Result<KlankRun> run_klank(std::size_t modes, std::size_t block, double seconds, const fs::path& folder) {
  const fs::path definition = fs::absolute(folder / "klank.scsyndef"), score = folder / "klank.osc",
                 sound = folder / "klank.raw";
  const auto wrote = write_klank_definition(definition, kKlankModes);
  if (!wrote) return fail(wrote.error());
  const auto scored = write_klank_score(score, definition, modes / kKlankModes, seconds);
  if (!scored) return fail(scored.error());
  const auto done =
      run_child({.command = {"scsynth", "-N", score, "_", sound, std::to_string(std::lround(kRate)), "RAW", "float",
                             "-i", "0", "-o", "1", "-z", std::to_string(block), "-D", "0"},
                 .limit_s = kLimit_s});
  if (!done) return fail(done.error());
  if (done->exit_code != 0) return fail(ErrorKind::refused, "scsynth: " + last_line(done->errors));
  const bool sounds = rings(sound);
  std::error_code ignored;
  fs::remove(sound, ignored);
  if (!sounds) return fail(ErrorKind::refused, "scsynth gave no sound");
  return KlankRun{done->processor_s, done->peak_mib * 1024 * 1024};
}

}  // namespace ringdown::bench
