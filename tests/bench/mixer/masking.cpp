// What masking saves and what it loses: preset banks, struck at random.
#include "engine/modal/bank_file.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 128;

std::vector<Map> preset_banks() {
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(RINGDOWN_SOURCE_DIR "/presets/banks")) {
    if (file.path().extension() == ".glb") files.push_back(file.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Map> maps;
  for (const auto& file : files) {
    if (auto bank = modal::read_bank(file)) {
      maps.push_back(std::make_shared<const modal::StrikeMap>(test::shared(std::move(*bank))));
    }
  }
  return maps;
}

struct Played {
  test::Samples left;
  std::uint64_t modes = 0;  // computed, summed over blocks
  BlockTimes times;
};

// The slowest hundredth left out: other programs took part of it. Surveys, in every sixteenth block, are in.
double total(const Played& played) {
  std::vector<double> blocks = played.times.blocks_s;
  std::sort(blocks.begin(), blocks.end());
  return std::accumulate(blocks.begin(), blocks.end() - static_cast<std::ptrdiff_t>(blocks.size() / 100), 0.0);
}

// So many of each bank, struck five times within two seconds, blows over a range of `spread_db`.
Played play(const std::vector<Map>& maps, std::size_t each, double spread_db, bool masking) {
  std::mt19937 random(11);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  synth::Mixer mixer(kRate);
  mixer.set_masking(masking);
  for (std::size_t i = 0; i < each * maps.size(); ++i) {
    const Map& map = maps[i % maps.size()];
    const auto object = static_cast<synth::ObjectNumber>(i);
    if (!mixer.install(object, std::make_unique<synth::Voice>(map, modal::MaterialScale{}, kRate),
                       synth::Mixer::Install::replace)) {
      continue;
    }
    for (int strike = 0; strike < 5; ++strike) {
      const double impulse = 0.05 * std::pow(10.0, -spread_db * uniform() / 20);
      const synth::Event event{.frame = static_cast<synth::Frame>(2 * kRate * uniform()),
                               .object = object,
                               .type = synth::EventType::strike_vertex,
                               .vertex = static_cast<std::uint32_t>(random() % map->bank().point_count()),
                               .impulse_ns = {impulse * uniform(), impulse * uniform(), impulse * uniform()},
                               .contact_time_s = 0.0003};
      static_cast<void>(mixer.push(synth::Producer::control, event));
    }
  }
  Played played;
  std::vector<float> left(kBlock), right(kBlock);
  const auto blocks = static_cast<std::size_t>(4 * kRate / kBlock);
  const auto render = [&] {
    mixer.render(left, right);
    played.modes += mixer.counters().ringing_modes.load();
    played.left.insert(played.left.end(), left.begin(), left.end());
  };
  played.left.reserve(blocks * kBlock);
  time_blocks(render, blocks, played.times);
  return played;
}

}  // namespace

void measure_masking(const Settings& settings, const Sink& sink) {
  const std::vector<Map> maps = preset_banks();
  struct Scene {
    const char* name;
    std::size_t each;
    double spread_db;
  };
  for (const Scene& scene : {Scene{"one of each", 1, 0}, Scene{"crowd", 20, 0}, Scene{"crowd of 60 dB", 20, 60}}) {
    Played plain, masked;
    for (int repeat = 0; repeat < (settings.quick ? 1 : 5); ++repeat) {
      Played p = play(maps, scene.each, scene.spread_db, false), m = play(maps, scene.each, scene.spread_db, true);
      plain.times.blocks_s.insert(plain.times.blocks_s.end(), p.times.blocks_s.begin(), p.times.blocks_s.end());
      masked.times.blocks_s.insert(masked.times.blocks_s.end(), m.times.blocks_s.begin(), m.times.blocks_s.end());
      plain.left = std::move(p.left), masked.left = std::move(m.left);
      plain.modes = p.modes, masked.modes = m.modes;
    }
    const std::size_t blocks = masked.left.size() / kBlock;
    for (const Played* played : {&plain, &masked}) {
      Row row{.part = "masking", .who = std::string(scene.name) + (played == &plain ? "" : "; masked")};
      row.modes = played->modes / blocks, row.objects = scene.each * maps.size(), row.block = kBlock;
      fill_in(row, played->times);
      row.modes_per_core = kNone;
      if (played == &masked) {
        row.ratio = total(masked) / total(plain);
        row.error_db = test::relative_error_db(masked.left, plain.left);
      }
      sink(row);
    }
  }
}

}  // namespace ringdown::bench
