#include "tests/bench/mixer/kernels.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/timing.h"

#include "engine/base/realtime.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128, kModes = 2000;
constexpr double kMinutes10_s = 600;

// Far over full scale, so that none of the modes comes near the mixer's floor, in which they would be left out.
constexpr Spread kAudible = {.modes = kModes,
                             .low_hz = 20,
                             .high_hz = 0.499 * kRate,
                             .shortest_t60_s = 0.005,
                             .longest_t60_s = kMinutes10_s,
                             .amplitude = 1e6};

using Render = std::function<void(std::span<double>)>;  // one block

// The sum in extended precision.
std::vector<double> closed_form(const std::vector<Sinusoid>& modes, double start_s, std::size_t frames) {
  std::vector<double> sum;
  const auto frame = static_cast<long double>(start_s * kRate);
  for (std::size_t n = 0; n < frames; ++n) {
    const long double t = (frame + static_cast<long double>(n)) / static_cast<long double>(kRate);
    long double value = 0;
    for (const Sinusoid& m : modes) {
      const long double phase = 2 * std::numbers::pi_v<long double> * static_cast<long double>(m.frequency_hz) * t;
      value += static_cast<long double>(m.amplitude) * std::exp(-static_cast<long double>(m.decay_per_s) * t) *
               std::sin(phase);
    }
    sum.push_back(static_cast<double>(value));
  }
  return sum;
}

double relative_error_db(const std::vector<double>& values, const std::vector<double>& reference) {
  double error = 0, energy = 0;
  for (std::size_t n = 0; n < reference.size(); ++n) {
    error += (values[n] - reference[n]) * (values[n] - reference[n]);
    energy += reference[n] * reference[n];
  }
  return 10 * std::log10(error / energy);
}

// Renders on from `*frame` up to `start_s`, and then as many samples as the reference has.
double error_at(double start_s, const std::vector<double>& reference, const Render& render, std::size_t* frame) {
  std::vector<double> block(kBlock), heard;
  for (; static_cast<double>(*frame) < start_s * kRate; *frame += kBlock) render(block);
  for (; heard.size() < reference.size(); *frame += kBlock) {
    render(block);
    heard.insert(heard.end(), block.begin(), block.end());
  }
  return relative_error_db(heard, reference);
}

struct Contender {
  std::string name;
  bool lasts;
  std::function<Render(const Map&)> start;
};

Render start_mixer(const Map& map) {
  const auto stage = std::make_shared<Stage>(kBlock);
  stage->install(0, map);
  stage->push(strike_of(0));
  return [stage](std::span<double> out) {
    stage->render();
    std::transform(stage->left().begin(), stage->left().end(), out.begin(),
                   [](float x) { return static_cast<double>(x) / Stage::kPan; });
  };
}

std::vector<Contender> contenders(bool quick) {
  std::vector<Contender> list;
  for (const KernelMaker& maker : kernels()) {
    list.push_back({maker.name, maker.lasts && !quick, [&maker](const Map& map) -> Render {
                      const std::shared_ptr<Kernel> made = maker.make(sinusoids_of(map->bank()));
                      return [made](std::span<double> out) { made->render(out); };
                    }});
  }
  list.push_back({"ours: mixer", true, start_mixer});
  return list;
}

double modes_per_core(const Contender& contender, double seconds) {
  const Render render = contender.start(bank_of({.modes = kModes}));
  std::vector<double> out(kBlock);
  BlockTimes times;
  for (int repeat = 0; repeat < 5; ++repeat) time_repeat([&] { render(out); }, seconds / 5, times);
  return static_cast<double>(kModes * kBlock) / kRate / median(times.repeats_s);
}

}  // namespace

void measure_accuracy(const Settings& settings, const Sink& sink) {
  const DenormalGuard guard;  // no kernel is slowed by denormal numbers, or lost for its users' lack of a guard
  const std::size_t frames = settings.quick ? 4 * kBlock : 16 * kBlock;
  const Map map = bank_of(kAudible);
  const auto modes = sinusoids_of(map->bank());
  const auto after_second = closed_form(modes, 1, frames), after_minutes = closed_form(modes, kMinutes10_s, frames);
  for (const Contender& contender : contenders(settings.quick)) {
    Row row{.part = "accuracy", .who = contender.name, .modes = kModes, .objects = 1, .block = kBlock, .time_s = 1};
    row.modes_per_core = modes_per_core(contender, settings.quick ? 0.05 : 1);
    const Render render = contender.start(map);
    std::size_t frame = 0;
    row.error_db = error_at(row.time_s, after_second, render, &frame);
    sink(row);
    if (!contender.lasts) continue;
    row.time_s = kMinutes10_s;
    row.error_db = error_at(row.time_s, after_minutes, render, &frame);
    sink(row);
  }
}

}  // namespace ringdown::bench
