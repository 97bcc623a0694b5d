#include "tests/bench/mixer/stage.h"

#include "tests/bench/mixer/timing.h"
#include "tests/support/synthetic_bank.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace ringdown::bench {
namespace {

constexpr double kGoldenRatio = 0.61803398874989485;  // its multiples, modulo 1, are spread evenly

double between(double low, double high, double fraction) { return low * std::pow(high / low, fraction); }

double omega_of(double frequency_hz) { return 2 * std::numbers::pi * frequency_hz; }

}  // namespace

Map bank_of(const Spread& spread, std::size_t first, std::size_t step) {
  modal::Bank bank = test::single_mode_bank(1, 1);
  bank.frequency_hz.clear(), bank.decay_per_s.clear(), bank.shapes.clear();
  bank.radiation->maps.modes.clear();
  for (std::size_t m = first; m < spread.modes; m += step) {
    const double place = (static_cast<double>(m) + 0.5) / static_cast<double>(spread.modes);
    const double hz = between(spread.low_hz, spread.high_hz, place);
    const double other_place = std::fmod(kGoldenRatio * static_cast<double>(m), 1.0);
    const double t60_s = between(spread.shortest_t60_s, spread.longest_t60_s, other_place);
    const double shape = spread.amplitude / (ringdown::test::kLoudness * omega_of(hz));
    bank.frequency_hz.push_back(hz);
    bank.radiation->maps.modes.push_back(test::even_field(hz));
    bank.decay_per_s.push_back(std::log(1000.0) / t60_s);
    bank.shapes.insert(bank.shapes.end(), bank.point_count(), {0, 0, static_cast<float>(shape)});
  }
  return std::make_shared<const modal::StrikeMap>(test::shared(std::move(bank)));
}

synth::Event strike_of(synth::ObjectNumber object) {
  return {.object = object,
          .verb = synth::verb::StrikeVertex{.vertex = 0, .impulse_ns = {0, 0, 1}, .contact_time_s = 0}};
}

std::vector<Sinusoid> sinusoids_of(const modal::Bank& bank) {
  std::vector<Sinusoid> list;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double shape = bank.shape(m, 0)[2];
    list.push_back({bank.frequency_hz[m], bank.decay_per_s[m],
                    ringdown::test::kLoudness * omega_of(bank.frequency_hz[m]) * shape});
  }
  return list;
}

void Stage::install(synth::ObjectNumber object, const Map& map) {
  install(object, std::make_shared<synth::ModeTable>(map, modal::MaterialScale{}, kRate));
}

void Stage::install(synth::ObjectNumber object, const std::shared_ptr<synth::ModeTable>& table) {
  auto voice = std::make_unique<synth::Voice>(table);
  if (mixer_.install(object, std::move(voice), synth::Mixer::Install::replace)) return;
  std::fprintf(stderr, "the mixer has no room for object %u\n", object);
  std::exit(1);
}

void Stage::push(const synth::Event& event) {
  if (!mixer_.push(synth::Producer::control, event)) ++lost_;
}

void Stage::render() { mixer_.render(left_, right_); }

std::unique_ptr<Stage> ringing_stage(const Spread& spread, std::size_t objects, std::size_t block,
                                     double* bytes_per_mode, std::size_t threads) {
  std::vector<Map> maps;
  for (std::size_t object = 0; object < objects; ++object) maps.push_back(bank_of(spread, object, objects));
  auto stage = std::make_unique<Stage>(block);
  if (threads > 1) stage->set_threads(threads);
  // A silent object comes first, because a mixer's first object makes what all objects share.
  stage->install(static_cast<synth::ObjectNumber>(objects),
                 std::make_shared<const modal::StrikeMap>(test::shared(test::single_mode_bank(1, 1))));
  const double before = heap_bytes();
  for (std::size_t object = 0; object < objects; ++object) {
    stage->install(static_cast<synth::ObjectNumber>(object), maps[object]);
  }
  stage->render();
  if (bytes_per_mode) *bytes_per_mode = (heap_bytes() - before) / static_cast<double>(spread.modes);
  for (std::size_t object = 0; object < objects; ++object) {
    stage->push(strike_of(static_cast<synth::ObjectNumber>(object)));
  }
  stage->render();
  return stage;
}

}  // namespace ringdown::bench
