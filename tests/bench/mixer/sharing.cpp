// Instances that share states, and threads that share work.
#include "tests/bench/machine.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <array>
#include <memory>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128;

// `instances` objects of one bank, struck; of one table, or each of its own.
std::unique_ptr<Stage> instances_of(const Map& map, std::size_t instances, bool of_one_table) {
  auto stage = std::make_unique<Stage>(kBlock);
  const auto table = std::make_shared<synth::ModeTable>(map, modal::MaterialScale{}, kRate);
  for (std::size_t i = 0; i < instances; ++i) {
    const auto object = static_cast<synth::ObjectNumber>(i);
    if (of_one_table) {
      stage->install(object, table);
    } else {
      stage->install(object, map);
    }
    stage->push(strike_of(object));
  }
  stage->render();
  stage->render();
  return stage;
}

}  // namespace

void measure_instances(const Settings& settings, const Sink& sink) {
  constexpr std::size_t kInstances = 1000, kModes = 100;
  const Map map = bank_of({.modes = kModes, .amplitude = 1e-4});
  struct Case {
    const char* who;
    std::unique_ptr<Stage> stage;
    std::size_t objects;
    BlockTimes times;
  };
  std::array cases = {Case{"shared", instances_of(map, kInstances, true), kInstances, {}},
                      Case{"each alone", instances_of(map, kInstances, false), kInstances, {}},
                      Case{"two banks", instances_of(map, 2, false), 2, {}}};
  for (int r = 0; r < (settings.quick ? 5 : 25); ++r) {
    for (Case& c : cases) time_repeat([&] { c.stage->render(); }, settings.quick ? 0.01 : 0.05, c.times);
  }
  for (Case& c : cases) {
    Row row{.part = "instances", .who = c.who, .modes = c.objects * kModes, .objects = c.objects, .block = kBlock};
    fill_in(row, c.times);
    row.ratio = median(c.times.repeats_s) / median(cases[0].times.repeats_s);
    row.modes_per_core = kNone;
    sink(row);
  }
}

// Wall time: what counts is when the block is done.
void measure_threads(const Settings& settings, const Sink& sink) {
  constexpr std::size_t kThreads = 2;
  hold_to_cores(kThreads);
  for (const std::size_t objects : {10, 100, 1000}) {
    const Spread spread{.modes = 100 * 300, .amplitude = 1e-4};
    std::array<std::unique_ptr<Stage>, kThreads> stages;
    std::array<BlockTimes, kThreads> times;
    for (std::size_t i = 0; i < kThreads; ++i) {
      stages[i] = ringing_stage(spread, objects, kBlock, nullptr, i + 1);
    }
    for (int r = 0; r < (settings.quick ? 10 : 60); ++r) {
      for (std::size_t i = 0; i < kThreads; ++i) time_blocks([&] { stages[i]->render(); }, 100, times[i]);
    }
    for (std::size_t i = 0; i < kThreads; ++i) {
      Row row{.part = "threads",
              .who = i == 0 ? "1 thread" : "2 threads",
              .modes = spread.modes,
              .objects = objects,
              .block = kBlock};
      fill_in(row, times[i]);
      row.ratio = median(times[0].blocks_s) / median(times[i].blocks_s);
      row.mean_us = row.modes_per_core = kNone;
      sink(row);
    }
  }
  hold_to_cores(1);
}

}  // namespace ringdown::bench
