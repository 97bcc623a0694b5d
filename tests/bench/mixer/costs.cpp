#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"
#include "tests/support/synthetic_bank.h"

#include <array>
#include <cmath>
#include <random>
#include <utility>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128;

// Modes and surface at random, as objects have them: T60 from 50 ms to 5 s.
Map random_object(std::uint32_t seed, std::size_t modes) {
  constexpr std::size_t kPoints = 500;
  return std::make_shared<const modal::StrikeMap>(test::shared(test::random_bank(seed, modes, kPoints)));
}

// Strikes objects somewhere, at some time within a block.
class Player {
 public:
  synth::Event strike(synth::ObjectNumber object, synth::Frame block_start) {
    return {.frame = block_start + static_cast<synth::Frame>(random_() % kBlock),
            .object = object,
            .verb = synth::verb::Strike{.point_m = {coordinate(), coordinate(), coordinate()},
                                        .impulse_ns = {1e-3, 2e-3, 3e-3},
                                        .contact_time_s = 1e-4}};
  }
  synth::ObjectNumber any_of(std::size_t objects) { return static_cast<synth::ObjectNumber>(random_() % objects); }

 private:
  double coordinate() { return std::uniform_real_distribution<double>(-0.1, 0.1)(random_); }
  std::mt19937 random_{1};
};

// 10 ringing objects, with a strike on each in every block and without; by turns.
Row strike_cost(std::size_t modes, bool quick) {
  constexpr std::size_t kObjects = 10;
  const std::size_t repeats = quick ? 5 : 25;
  std::array<BlockTimes, 2> times;
  Stage stage(kBlock);
  Player player;
  const auto strike_all = [&] {
    for (std::size_t object = 0; object < kObjects; ++object) {
      stage.push(player.strike(static_cast<synth::ObjectNumber>(object), stage.frame()));
    }
  };
  for (std::size_t object = 0; object < kObjects; ++object) {
    stage.install(static_cast<synth::ObjectNumber>(object), random_object(static_cast<std::uint32_t>(object), modes));
  }
  strike_all();
  for (std::size_t r = 0; r < repeats; ++r) {
    time_blocks([&] { strike_all(), stage.render(); }, 100, times[1]);
    time_blocks([&] { stage.render(); }, 100, times[0]);
  }
  Row row{.part = "strike", .modes = modes, .objects = kObjects, .block = kBlock};
  row.mean_us = 1e6 * (median(times[1].repeats_s) - median(times[0].repeats_s)) / kObjects;
  return row;
}

// Measures the load of 1,000 objects of 50 modes that are struck `strikes_per_second` times in all.
Row storm(double strikes_per_second, double seconds) {
  constexpr std::size_t kObjects = 1000, kModes = 50, kBanks = 10;
  std::vector<Map> maps;
  for (std::uint32_t seed = 0; seed < kBanks; ++seed) maps.push_back(random_object(seed, kModes));
  Stage stage(kBlock);
  for (std::size_t object = 0; object < kObjects; ++object) {
    stage.install(static_cast<synth::ObjectNumber>(object), maps[object % kBanks]);
  }
  Player player;
  double due = 0;
  const auto play_block = [&] {
    for (due += strikes_per_second * kBlock / kRate; due >= 1; --due) {
      stage.push(player.strike(player.any_of(kObjects), stage.frame()));
    }
    stage.render();
  };
  BlockTimes times;
  const auto blocks_per_second = static_cast<std::size_t>(kRate / kBlock);
  time_blocks(play_block, blocks_per_second, times);  // until all objects ring
  times = {};
  for (double s = 0; s < seconds; ++s) time_blocks(play_block, blocks_per_second, times);
  Row row{.part = "storm", .modes = kObjects * kModes, .objects = kObjects, .block = kBlock};
  fill_in(row, times);
  row.modes_per_core = kNone;  // most of the work is strikes
  if (stage.lost() > 0) row.status = "failed: " + std::to_string(stage.lost()) + " strikes were lost";
  return row;
}

}  // namespace

void measure_silence(const Settings& settings, const Sink& sink) {
  constexpr std::size_t kObjects = 1000, kModes = 100;
  const Map map = random_object(1, kModes);
  Stage stage(kBlock);
  for (std::size_t object = 0; object < kObjects; ++object) {
    stage.install(static_cast<synth::ObjectNumber>(object), map);
  }
  BlockTimes times;
  for (int r = 0; r < 15; ++r) time_repeat([&] { stage.render(); }, settings.quick ? 0.005 : 0.05, times);
  Row row{.part = "silence", .objects = kObjects, .block = kBlock};
  fill_in(row, times);
  sink(row);
}

void measure_strikes(const Settings& settings, const Sink& sink) {
  for (const std::size_t modes : {100, 500}) sink(strike_cost(modes, settings.quick));
}

void measure_storm(const Settings& settings, const Sink& sink) { sink(storm(10000, settings.quick ? 1 : 5)); }

void grow_strikes(const Settings& settings, const Sink& sink) {
  for (const double strikes : {100, 300, 1000, 3000, 10000, 30000}) {
    Row row = storm(strikes, settings.quick ? 1 : 5);
    row.part = "growth";
    row.who = "strikes a second";
    row.count = strikes;
    sink(row);
  }
}

void measure_decay(const Settings& settings, const Sink& sink) {
  constexpr std::size_t kObjects = 200, kModes = 100, kRows = 60, kBlocksPerRow = 75;  // a row is 0.2 s
  std::vector<Map> maps;
  for (std::uint32_t seed = 0; seed < kObjects; ++seed) maps.push_back(random_object(seed, kModes));
  std::vector<BlockTimes> times(kRows);
  std::vector<std::size_t> audible(kRows);
  for (int repeat = 0; repeat < (settings.quick ? 1 : 5); ++repeat) {
    Stage stage(kBlock);
    Player player;
    for (std::size_t object = 0; object < kObjects; ++object) {
      stage.install(static_cast<synth::ObjectNumber>(object), maps[object]);
      stage.push(player.strike(static_cast<synth::ObjectNumber>(object), 0));
    }
    stage.render();
    for (std::size_t i = 0; i < kRows; ++i) {
      audible[i] = stage.ringing_modes();
      time_blocks([&] { stage.render(); }, kBlocksPerRow, times[i]);
    }
  }
  for (std::size_t i = 0; i < kRows; ++i) {
    Row row{.part = "decay", .modes = audible[i], .objects = kObjects, .block = kBlock};
    row.time_s = static_cast<double>(i * kBlocksPerRow * kBlock) / kRate;
    fill_in(row, times[i]);
    row.modes_per_core = kNone;
    sink(row);
  }
}

void measure_tail(const Settings& settings, const Sink& sink) {
  constexpr std::size_t kModes = 1000;
  constexpr double kT60_s = 0.5, kFloatDenormal = 1.2e-38, kFloatZero = 1.4e-45, kDenormal = 2.2e-308, kZero = 4.9e-324;
  struct Range {
    const char* name;
    double from_s, to_s;  // while the dying modes are between two amplitudes
  };
  const auto time_of = [](double amplitude) { return -std::log10(amplitude) * kT60_s / 3; };
  const std::array ranges = {Range{"loud", 0, 0.2},
                             Range{"denormal float", time_of(kFloatDenormal), time_of(kFloatZero)},
                             Range{"denormal double", time_of(kDenormal), time_of(kZero)}};
  std::array<BlockTimes, ranges.size()> times;
  Spread dying{.modes = kModes, .shortest_t60_s = kT60_s, .longest_t60_s = kT60_s, .amplitude = 1};
  modal::Bank bank = bank_of(dying)->bank();
  bank.decay_per_s[kModes / 2] = 0.001;
  const Map map = std::make_shared<const modal::StrikeMap>(test::shared(std::move(bank)));
  for (int repeat = 0; repeat < (settings.quick ? 2 : 7); ++repeat) {
    Stage stage(kBlock);
    stage.install(0, map);
    stage.push(strike_of(0));
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto seconds = [&] { return static_cast<double>(stage.frame()) / kRate; };
      while (seconds() < ranges[i].from_s) stage.render();
      const auto blocks = static_cast<std::size_t>((ranges[i].to_s - seconds()) * kRate / kBlock);
      time_blocks([&] { stage.render(); }, blocks, times[i]);
    }
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    Row row{.part = "tail", .who = ranges[i].name, .modes = kModes, .objects = 1, .block = kBlock};
    fill_in(row, times[i]);
    row.ratio = median(times[i].blocks_s) / median(times[0].blocks_s);
    row.modes_per_core = kNone;
    sink(row);
  }
}

}  // namespace ringdown::bench
