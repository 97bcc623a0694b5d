// Impacts, slides and rolls that are recovered from keyframes, against those of the simulation that the keyframes were
// recorded from: the table of docs/use/film.md.
//
//   foley_truth                             every scene at 24, 30 and 60 frames a second
//   foley_truth [--each] SCENE [FPS ...]    one scene; with --each, every impact as well
#include "tests/scene/keyframes.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace ringdown;

void add_row(const std::string& name, double fps, bool each) {
  const test::Preset preset = test::preset_scene(name);
  const test::Played truth = test::simulate(preset.scene, preset.objects, fps);
  const auto begin = std::chrono::steady_clock::now();
  const auto recovered = test::play(truth.animated, preset.objects);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const test::Comparison c = test::compare(truth.contacts, recovered, fps, each);
  std::printf("| %s | %.0f | %zu of %zu | %zu | %.1f ms | %.1f ms | %.2f dB | %zu groups, %.1f dB | %zu of %zu |\n",
              name.c_str(), fps, c.found, c.alone, c.false_ones, c.time_ms, c.worst_ms, c.impulse_db, c.groups,
              c.group_db, c.ends_found, c.ends);
  std::fprintf(stderr, "%s at %.0f: %.1f s\n", name.c_str(), fps, took.count());
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> scenes;
  std::vector<double> rates;
  bool each = false;
  for (int k = 1; k < count; ++k) {
    const std::string text = arguments[k];
    char* end = nullptr;
    const double rate = std::strtod(text.c_str(), &end);
    if (text == "--each") {
      each = true;
    } else if (*end == '\0' && rate > 0) {
      rates.push_back(rate);
    } else {
      scenes.push_back(text);
    }
  }
  if (scenes.empty()) scenes = {"demo", "cutlery", "marble-rain", "dominoes"};
  if (rates.empty()) rates = {24, 30, 60};
  std::printf(
      "| scene | frames a second | found | false | 90 %% of the times within | all within | impulse, median error | "
      "dense blows | ends of slides |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : scenes) {
    for (const double rate : rates) add_row(scene, rate, each);
  }
  return 0;
}
