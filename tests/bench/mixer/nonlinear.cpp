// What thin objects cost: 10,000 modes in 100 objects whose pitches glide, beside the same without nonlinear terms; and
// one object whose modes exchange energy.
#include "engine/synth/modes/glide.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128;

// The bank with random terms of its lowest `modes` modes.
Map with_terms(const Map& map, std::size_t modes, std::size_t functions, bool exchange, float bending) {
  modal::Bank bank = map->bank();
  modal::NonlinearTerms terms{.thickness_m = 1};
  terms.coupled = exchange ? static_cast<std::uint32_t>(modes) : 0;
  std::mt19937 random(1);
  for (std::size_t m = 0; m < modes; ++m) terms.modes.push_back(static_cast<std::uint32_t>(m));
  for (std::size_t i = 0; i < functions * terms.pairs(); ++i)
    terms.bending.push_back(bending * (2 * (static_cast<float>(random()) / 4294967296.0F) - 1));
  terms.curving.assign(functions * modes, 0);
  bank.nonlinear = std::move(terms);
  return std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(bank)));
}

// Scaled so that strike_of(), with each mode at `amplitude`, detunes modes by up to `relative`.
Map detuned(const Map& map, std::size_t modes, std::size_t functions, bool exchange, double amplitude,
            double relative) {
  const synth::ModeTable table(with_terms(map, modes, functions, exchange, 1), modal::MaterialScale{}, kRate);
  double sum = 0;
  for (const float reach : table.glide->reach) sum += static_cast<double>(reach) * amplitude * amplitude;
  return with_terms(map, modes, functions, exchange, static_cast<float>(std::sqrt(relative / sum)));
}

struct Case {
  std::string who;
  std::size_t modes, objects;
  std::unique_ptr<Stage> stage = std::make_unique<Stage>(kBlock);
  BlockTimes times = {};
  int blocks = 0;
};

Case many_objects(const std::string& who, double relative) {
  constexpr std::size_t kObjects = 100, kModes = 10000;
  constexpr double kAmplitude = 1e-3;
  Case one{who, kModes, kObjects};
  const Spread spread{.modes = kModes, .longest_t60_s = 10, .amplitude = kAmplitude};
  for (std::size_t o = 0; o < kObjects; ++o) {
    const Map map = bank_of(spread, o, kObjects);
    one.stage->install(static_cast<synth::ObjectNumber>(o),
                       relative > 0 ? detuned(map, kModes / kObjects, 30, false, kAmplitude, relative) : map);
    one.stage->push(strike_of(static_cast<synth::ObjectNumber>(o)));
  }
  return one;
}

Case one_object(std::size_t modes, std::size_t functions) {
  constexpr double kAmplitude = 1e-2, kRelative = 0.02;
  Case one{"M " + std::to_string(modes) + ", K " + std::to_string(functions), modes, 1};
  const Map map = bank_of({.modes = modes, .high_hz = 4000, .longest_t60_s = 36000, .amplitude = kAmplitude});
  one.stage->install(0, detuned(map, modes, functions, true, kAmplitude, kRelative));
  one.stage->push(strike_of(0));
  return one;
}

}  // namespace

void measure_nonlinear(const Settings& settings, const Sink& sink) {
  std::vector<Case> cases;
  cases.push_back(many_objects("linear", 0));
  cases.push_back(many_objects("calm", 1e-7));
  cases.push_back(many_objects("gliding", 0.01));
  cases.push_back(one_object(50, 30));
  cases.push_back(one_object(64, 50));
  const auto play = [](Case& c) {  // the many objects are struck once a second
    if (c.objects > 1 && ++c.blocks % (static_cast<int>(kRate) / static_cast<int>(kBlock)) == 0) {
      for (std::size_t o = 0; o < c.objects; ++o) c.stage->push(strike_of(static_cast<synth::ObjectNumber>(o)));
    }
    c.stage->render();
  };
  for (Case& c : cases) {
    for (int block = 0; block < 20; ++block) play(c);
  }
  for (int r = 0; r < (settings.quick ? 8 : 40); ++r) {
    for (Case& c : cases) time_repeat([&] { play(c); }, settings.quick ? 0.02 : 0.06, c.times);
  }
  for (Case& c : cases) {
    Row row{.part = "nonlinear", .who = c.who, .modes = c.modes, .objects = c.objects, .block = kBlock};
    fill_in(row, c.times);
    const double over = c.objects == 1 ? kBlock / kRate : median(cases[0].times.repeats_s);
    row.ratio = median(c.times.repeats_s) / over;
    const bool exchanges = c.stage->coupled_voices() > 0;
    if (exchanges != (c.objects == 1)) row.status = "failed: modes that should exchange energy do not, or others do";
    sink(row);
  }
}

}  // namespace ringdown::bench
