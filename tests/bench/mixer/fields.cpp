// What it costs to render the field around the listener: ambisonic channels, and a head's ears, beside stereo.
#include "server/session/head.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128, kObjects = 100, kModes = 10000;

class Round {
 public:
  Round(const std::vector<Map>& maps, synth::MixerSettings settings) : mixer_(kRate, settings) {
    const std::size_t channels = settings.ambisonic_order ? synth::ambisonic_channels(*settings.ambisonic_order) : 0;
    blocks_.resize(channels > 0 ? channels : 2, std::vector<float>(kBlock));
    for (std::size_t c = 0; c < blocks_.size(); ++c) {
      if (channels > 0) {
        outputs_.listen_to_ambisonics(c, blocks_[c].data());
      } else {
        outputs_.listen_to_mix(c, blocks_[c].data());
      }
    }
    for (std::size_t o = 0; o < maps.size(); ++o) {
      const auto object = static_cast<synth::ObjectNumber>(o);
      auto voice = std::make_unique<synth::Voice>(mixer_.table_for(maps[o], {}));
      ok_ = mixer_.install(object, std::move(voice), synth::Mixer::Install::replace) && ok_;
      const double pan = 2.0 * static_cast<double>(o) / static_cast<double>(maps.size()) - 1;
      ok_ = mixer_.push(synth::Producer::control, {.object = object, .verb = synth::verb::Pan{pan}}) && ok_;
    }
    render();
    for (std::size_t o = 0; o < maps.size(); ++o) {
      ok_ = mixer_.push(synth::Producer::control, strike_of(static_cast<synth::ObjectNumber>(o))) && ok_;
    }
    render();
  }
  void render() { mixer_.render(outputs_, kBlock); }
  [[nodiscard]] bool rings() const { return ok_ && mixer_.counters().ringing_modes.load() == kModes; }

 private:
  synth::Mixer mixer_;
  std::vector<std::vector<float>> blocks_;
  synth::Outputs outputs_;
  bool ok_ = true;
};

std::vector<Map> standing_objects() {
  std::vector<Map> maps;
  for (std::size_t o = 0; o < kObjects; ++o) maps.push_back(bank_of({.modes = kModes, .amplitude = 1e-4}, o, kObjects));
  return maps;
}

}  // namespace

void measure_fields(const Settings& settings, const Sink& sink) {
  const std::vector<Map> maps = standing_objects();
  const auto head = session::read_head("");
  struct Case {
    const char* who;
    std::unique_ptr<Round> round;
    BlockTimes times = {};
  };
  std::vector<Case> cases;
  cases.push_back({"stereo", std::make_unique<Round>(maps, synth::MixerSettings{})});
  cases.push_back({"ambisonics 1", std::make_unique<Round>(maps, synth::MixerSettings{.ambisonic_order = 1})});
  cases.push_back({"ambisonics 3", std::make_unique<Round>(maps, synth::MixerSettings{.ambisonic_order = 3})});
  if (head) cases.push_back({"binaural", std::make_unique<Round>(maps, synth::MixerSettings{.head = *head})});
  for (int r = 0; r < (settings.quick ? 8 : 40); ++r) {
    for (Case& c : cases) time_repeat([&] { c.round->render(); }, settings.quick ? 0.02 : 0.06, c.times);
  }
  const double stereo = median(cases[0].times.repeats_s);
  for (Case& c : cases) {
    Row row{.part = "fields", .who = c.who, .modes = kModes, .objects = kObjects, .block = kBlock};
    if (!c.round->rings()) row.status = "failed: not all modes ring";
    fill_in(row, c.times);
    row.ratio = median(c.times.repeats_s) / stereo;
    sink(row);
  }
}

void grow_channels(const Settings& settings, const Sink& sink) {
  const std::vector<Map> maps = standing_objects();
  for (std::size_t order = 0; order <= 3; ++order) {  // 0: stereo
    synth::MixerSettings mixer;
    if (order > 0) mixer.ambisonic_order = order;
    Round round(maps, mixer);
    BlockTimes times;
    for (int r = 0; r < (settings.quick ? 5 : 15); ++r) {
      time_repeat([&] { round.render(); }, settings.quick ? 0.02 : 0.06, times);
    }
    Row row{.part = "growth", .who = "channels", .modes = kModes, .objects = kObjects, .block = kBlock};
    row.count = order == 0 ? 2 : static_cast<double>(synth::ambisonic_channels(order));
    fill_in(row, times);
    if (!round.rings()) row.status = "failed: not all modes ring";
    sink(row);
  }
}

}  // namespace ringdown::bench
