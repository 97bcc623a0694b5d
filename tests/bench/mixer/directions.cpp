// What it costs to hear objects from their places: standing still, turning, and flying past.
#include "engine/base/rotation.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128, kObjects = 100, kModes = 10000;
constexpr double kRadius_m = 0.1;  // of the bodies whose maps are made up
constexpr double kTurn_rad_s = 2 * std::numbers::pi;
constexpr double kPoses_hz = 60;
constexpr int kSettles = 400;   // blocks, until looks at maps are spread over chunks
constexpr int kMaxDegree = 20;  // beyond which a body's lobes add little

// Maps as bodies of 20 cm have them: lobes up to the degree k R + 1, of one symmetry.
Map with_lobes(const Map& map, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random] { return 2 * (static_cast<float>(random()) / 4294967296.0F) - 1; };
  modal::Bank bank = map->bank();
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    modal::FarField& field = bank.radiation->maps.modes[m];
    const double wave = 2 * std::numbers::pi * bank.frequency_hz[m] / bank.radiation->air.sound_speed_m_s;
    const int degree = std::min(1 + static_cast<int>(wave * kRadius_m), kMaxDegree);
    const double level = modal::rms(field);
    field.terms.clear();
    for (int l = 0; l <= degree; ++l) {
      for (int i = -l; i <= l; ++i) {
        if ((l + i + static_cast<int>(m)) % 2 != 0) continue;
        field.terms.push_back({static_cast<std::uint16_t>(l * l + l + i), {uniform(), 0.3F * uniform()}});
      }
    }
    const auto scale = static_cast<float>(level / modal::rms(field));
    for (modal::FarField::Term& term : field.terms) term.value *= scale;
    field.unit = 0;
  }
  return std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(bank)));
}

enum class Moves { unheard, stand, turn, fly };

// The objects ring, and how they move is told kPoses_hz times a second.
class Round {
 public:
  Round(const std::vector<Map>& maps, Moves moves) : moves_(moves), stage_(std::make_unique<Stage>(kBlock)) {
    for (std::size_t o = 0; o < maps.size(); ++o) stage_->install(static_cast<synth::ObjectNumber>(o), maps[o]);
    if (moves != Moves::unheard) stage_->push({.verb = synth::verb::Listener{}});
    tell();
    stage_->render();
    for (std::size_t o = 0; o < maps.size(); ++o) stage_->push(strike_of(static_cast<synth::ObjectNumber>(o)));
    for (int block = 0; block < kSettles; ++block) render();
  }
  void render() {
    if (moves_ >= Moves::turn && static_cast<double>(stage_->frame()) >= next_) tell();
    stage_->render();
  }
  [[nodiscard]] std::size_t ringing_modes() const { return stage_->ringing_modes(); }

 private:
  void tell() {
    const double at = next_ + kRate / kPoses_hz;  // ahead of its time
    for (std::size_t o = 0; o < kObjects && moves_ != Moves::unheard; ++o) {
      const double place = 2.4 * static_cast<double>(o), t = moves_ == Moves::stand ? 0 : at / kRate;
      const double angle = place + kTurn_rad_s * t, away = 3 + (moves_ == Moves::fly ? 2 * std::sin(t + place) : 0);
      stage_->push({.frame = static_cast<synth::Frame>(at),
                    .object = static_cast<synth::ObjectNumber>(o),
                    .verb = synth::verb::Pose{{{away * std::cos(place), away * std::sin(place), 0.2},
                                               about({std::cos(place), 1, std::sin(place)}, angle)}}});
    }
    next_ = at;
  }
  Moves moves_;
  std::unique_ptr<Stage> stage_;
  double next_ = 0;
};

}  // namespace

void measure_directions(const Settings& settings, const Sink& sink) {
  std::vector<Map> maps;
  for (std::size_t o = 0; o < kObjects; ++o) {
    const Map plain = bank_of({.modes = kModes, .amplitude = 1e-4}, o, kObjects);
    maps.push_back(with_lobes(plain, static_cast<std::uint32_t>(o)));
  }
  struct Case {
    const char* who;
    Round round;
    BlockTimes times;
  };
  std::array cases = {Case{"without a listener", Round(maps, Moves::unheard), {}},
                      Case{"standing", Round(maps, Moves::stand), {}}, Case{"turning", Round(maps, Moves::turn), {}},
                      Case{"flying", Round(maps, Moves::fly), {}}};
  for (int r = 0; r < (settings.quick ? 8 : 40); ++r) {
    for (Case& c : cases) time_repeat([&] { c.round.render(); }, settings.quick ? 0.02 : 0.06, c.times);
  }
  const double standing = median(cases[1].times.repeats_s);
  for (Case& c : cases) {
    Row row{.part = "directions", .who = c.who, .modes = kModes, .objects = kObjects, .block = kBlock};
    if (c.round.ringing_modes() != kModes) row.status = "failed: " + std::to_string(c.round.ringing_modes()) + " ring";
    fill_in(row, c.times);
    row.ratio = standing / median(c.times.repeats_s);
    sink(row);
  }
}

}  // namespace ringdown::bench
