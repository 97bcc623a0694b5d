// How the time of a block grows. What is counted here are modes and objects; strikes, contacts and channels are counted
// where their cost is measured.
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <cstddef>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128;

void measure_ringing(const char* who, std::size_t modes, std::size_t objects, std::size_t count,
                     const Settings& settings, const Sink& sink) {
  const auto stage = ringing_stage({.modes = modes}, objects, kBlock);
  BlockTimes times;
  for (int r = 0; r < (settings.quick ? 5 : 15); ++r) {
    time_repeat([&] { stage->render(); }, settings.quick ? 0.01 : 0.05, times);
  }
  Row row{.part = "growth", .who = who, .modes = modes, .objects = objects, .block = kBlock};
  row.count = static_cast<double>(count);
  fill_in(row, times);
  if (stage->ringing_modes() != modes) row.status = "failed: not all modes ring";
  sink(row);
}

}  // namespace

void measure_growth(const Settings& settings, const Sink& sink) {
  const std::size_t max_modes = settings.quick ? 100'000 : 1'000'000;
  for (std::size_t modes = 10; modes <= max_modes; modes *= 10)
    measure_ringing("modes", modes, 1, modes, settings, sink);
  constexpr std::size_t kModes = 10'240, kMaxCount = 1024;
  for (std::size_t objects = 1; objects <= kMaxCount; objects *= 4) {
    measure_ringing("objects", kModes, objects, objects, settings, sink);
  }
  grow_strikes(settings, sink);
  grow_contacts(settings, sink);
  grow_channels(settings, sink);
}

}  // namespace ringdown::bench
