// What two-way contacts cost: 16 couplings of 200 and 200 modes with friction, in blocks of 64 frames, while they
// touch, while they are a hair's breadth apart, and while the same modes ring freely.
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <memory>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 64, kMaxCouplings = 16, kModes = 200;

enum class State { free, apart, touching };

std::unique_ptr<Stage> stage_in(State state, std::size_t couplings = kMaxCouplings) {
  auto stage = std::make_unique<Stage>(kBlock);
  for (std::size_t o = 0; o < 2 * couplings; ++o) {
    const auto object = static_cast<synth::ObjectNumber>(o);
    stage->install(object,
                   bank_of({.modes = 2 * couplings * kModes, .low_hz = 100, .amplitude = 1e-5}, o, 2 * couplings));
    stage->push(strike_of(object));
  }
  for (std::size_t c = 0; c < couplings && state != State::free; ++c) {
    const synth::verb::Couple couple{.other = static_cast<synth::ObjectNumber>(2 * c + 1),
                                     .direction = {0, 0, 1},
                                     .gap_m = state == State::touching ? -1e-4 : 0.01,
                                     .stiffness = 1e7,
                                     .bounce = 0.9};
    stage->push({.object = static_cast<synth::ObjectNumber>(2 * c), .verb = couple});
  }
  stage->render();
  stage->render();
  return stage;
}

}  // namespace

void measure_two_way(const Settings& settings, const Sink& sink) {
  struct Case {
    const char* who;
    std::unique_ptr<Stage> stage;
    BlockTimes times = {};
  };
  std::vector<Case> cases;
  cases.push_back({"free", stage_in(State::free)});
  cases.push_back({"apart", stage_in(State::apart)});
  cases.push_back({"touching", stage_in(State::touching)});
  for (int r = 0; r < (settings.quick ? 8 : 40); ++r) {
    for (Case& c : cases) time_repeat([&] { c.stage->render(); }, settings.quick ? 0.02 : 0.06, c.times);
  }
  for (Case& c : cases) {
    Row row{.part = "two-way",
            .who = c.who,
            .modes = 2 * kMaxCouplings * kModes,
            .objects = 2 * kMaxCouplings,
            .block = kBlock};
    fill_in(row, c.times);
    row.ratio = median(c.times.repeats_s) / (kBlock / kRate);
    if (c.stage->lost() > 0) row.status = "failed: an event was lost";
    sink(row);
  }
}

void grow_contacts(const Settings& settings, const Sink& sink) {
  for (std::size_t couplings = 1; couplings <= kMaxCouplings; couplings *= 2) {
    const auto stage = stage_in(State::touching, couplings);
    BlockTimes times;
    for (int r = 0; r < (settings.quick ? 5 : 15); ++r) {
      time_repeat([&] { stage->render(); }, settings.quick ? 0.02 : 0.06, times);
    }
    Row row{.part = "growth",
            .who = "two-way contacts",
            .modes = 2 * couplings * kModes,
            .objects = 2 * couplings,
            .block = kBlock};
    row.count = static_cast<double>(couplings);
    fill_in(row, times);
    if (stage->lost() > 0) row.status = "failed: an event was lost";
    sink(row);
  }
}

}  // namespace ringdown::bench
