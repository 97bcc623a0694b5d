// What the C interface costs: the mixer by itself, and the same behind libringdown.so, one strike in each block.
#include "clients/library/ringdown.h"
#include "engine/modal/bank_file.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"
#include "tests/support/temporary_folder.h"

#include <memory>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr std::size_t kBlock = 64, kObjects = 100, kModes = 10000;

class Library {
 public:
  explicit Library(const std::vector<Map>& maps) : left_(kBlock), right_(kBlock) {
    ringdown_settings settings;
    ringdown_settings_init(&settings, sizeof settings);
    settings.limiter_db = 1;  // none, as in the mixer beside it
    good_ = ringdown_mixer_create(&settings, &mixer_, nullptr) == RINGDOWN_OK;
    const test::TemporaryFolder folder;
    for (const Map& map : maps) {
      ringdown_bank* bank = nullptr;
      std::uint32_t number = 0;
      good_ = good_ && modal::write_bank(map->bank(), folder / "bank.glb").has_value() &&
              ringdown_bank_open((folder / "bank.glb").c_str(), &bank, nullptr) == RINGDOWN_OK &&
              ringdown_add(mixer_, nullptr, bank, &number, nullptr) == RINGDOWN_OK;
      ringdown_bank_release(bank);
    }
  }
  ~Library() { ringdown_mixer_destroy(mixer_); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void strike(std::uint32_t object) {
    const double point_m[3] = {0, 0, 0}, impulse_ns[3] = {0, 0, 1};
    good_ = ringdown_strike(mixer_, 0, object, point_m, impulse_ns, 0, nullptr) == RINGDOWN_OK && good_;
  }
  void render() { ringdown_render(mixer_, left_.data(), right_.data(), kBlock); }
  [[nodiscard]] bool rings() const {
    ringdown_status status{};
    status.size = sizeof status;
    return good_ && ringdown_get_status(mixer_, &status) == RINGDOWN_OK && status.ringing_modes == kModes;
  }

 private:
  ringdown_mixer* mixer_ = nullptr;
  std::vector<float> left_, right_;
  bool good_ = true;
};

}  // namespace

void measure_library(const Settings& settings, const Sink& sink) {
  std::vector<Map> maps;
  for (std::size_t o = 0; o < kObjects; ++o) maps.push_back(bank_of({.modes = kModes, .amplitude = 1e-4}, o, kObjects));
  Stage mixer(kBlock);
  Library library(maps);
  for (std::uint32_t o = 0; o < kObjects; ++o) {
    mixer.install(o, maps[o]);
    mixer.push(strike_of(o));
    library.strike(o);
  }
  BlockTimes own, behind;
  std::uint32_t next = 0;
  for (int r = 0; r < (settings.quick ? 10 : 60); ++r) {
    const double seconds = settings.quick ? 0.02 : 0.06;
    const auto one = [&next] { return next++ % static_cast<std::uint32_t>(kObjects); };
    time_repeat([&] { mixer.push(strike_of(one())), mixer.render(); }, seconds, own);
    time_repeat([&] { library.strike(one()), library.render(); }, seconds, behind);
  }
  const double alone = median(own.repeats_s);
  const auto tell = [&](const char* who, const BlockTimes& times, bool rings) {
    Row row{.part = "library", .who = who, .modes = kModes, .objects = kObjects, .block = kBlock};
    if (!rings) row.status = "failed: not all modes ring";
    fill_in(row, times);
    row.ratio = median(times.repeats_s) / alone;
    sink(row);
  };
  tell("mixer", own, mixer.ringing_modes() == kModes);
  tell("libringdown", behind, library.rings());
}

}  // namespace ringdown::bench
