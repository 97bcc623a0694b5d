// What the mixer's time budget counts with: what each kind of work costs for a mode, in units of what moments cost.
#include "engine/synth/kernels/channel_sums.h"
#include "engine/synth/modes/voice.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"
#include "tests/support/synthetic_bank.h"

#include <array>
#include <ctime>
#include <limits>
#include <utility>

namespace ringdown::bench {
namespace {

using synth::kChunkFrames;

constexpr std::size_t kVoices = 40, kModes = 500, kSums = 2;  // an instance group's sums: left and right
constexpr double kShare = 0.7, kFloor = 1e-12;
constexpr synth::Level kAllPass = synth::kNoThreshold, kLowThreshold = -900, kNonePasses = 100000;

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Voices that ring, each with sums of its own as if it had a group.
class Workshop {
 public:
  Workshop() {
    for (std::uint32_t seed = 0; seed < kVoices; ++seed) {
      auto map = std::make_shared<const modal::StrikeMap>(test::shared(test::random_bank(seed, kModes, 500)));
      auto table = std::make_shared<synth::ModeTable>(std::move(map), modal::MaterialScale{}, kRate);
      table->prepare(kChunkFrames);
      sums_.push_back({std::make_unique<synth::ModeStates>(*table), std::make_unique<synth::ModeStates>(*table)});
      voices_.push_back(std::make_unique<synth::Voice>(std::move(table)));
    }
    sums_of_chunk_.make_room();
    sums_of_chunk_.open(kChunkFrames);
    ring();
  }

  // Nanoseconds a mode, median of many: `work` is timed and `prepare`, before it, is not.
  template <class Prepare, class Work>
  double time(bool quick, const Prepare& prepare, const Work& work) {
    std::vector<double> times;
    for (int i = 0; i < (quick ? 40 : 200); ++i) {
      for (std::size_t v = 0; v < kVoices; ++v) prepare(v);
      const double begin = processor_s();
      for (std::size_t v = 0; v < kVoices; ++v) work(v);
      times.push_back(processor_s() - begin);
    }
    return 1e9 * median(times) / (kVoices * kModes);
  }

  void ring() {
    for (std::size_t v = 0; v < kVoices; ++v) ring(v);
  }
  void ring(std::size_t v) {
    apply(v, kAllPass);
    voice(v).silence();
    static_cast<void>(voice(v).strike(blow()));
    for (auto& sum : sums_[v]) sum->silence(), sum->add(voice(v).amplitudes(), 1);
  }
  synth::Voice& voice(std::size_t v) { return *voices_[v]; }
  std::array<std::unique_ptr<synth::ModeStates>, kSums>& sums(std::size_t v) { return sums_[v]; }

  void render_moments(std::size_t v) {
    const std::array targets = {synth::MomentTarget{sums_of_chunk_.moments(0), 0.7f},
                                synth::MomentTarget{sums_of_chunk_.moments(1), 0.7f}};
    static_cast<void>(voice(v).render_moments(targets, out_.data(), kChunkFrames, kFloor));
  }
  void render(std::size_t v) { static_cast<void>(voice(v).render(out_.data(), kChunkFrames, kFloor)); }
  void strike(std::size_t v) {
    static_cast<void>(voice(v).strike_late(blow(), kChunkFrames / 2));
    static_cast<void>(voice(v).render_late(out_.data(), kChunkFrames / 2));
    voice(v).merge_late();
  }
  void strike_in_group(std::size_t v) {
    static_cast<void>(voice(v).find_amplitudes(blow()));
    voice(v).skip(10000);
    voice(v).add(voice(v).amplitudes(), 1);
    voice(v).rest();
    for (auto& sum : sums_[v]) {
      sum->add_late(voice(v).amplitudes(), kShare, kChunkFrames / 2);
      static_cast<void>(sum->render_late(out_.data(), kChunkFrames / 2));
      sum->merge_late();
    }
  }
  void share(std::size_t v) {
    for (auto& sum : sums_[v]) sum->add(voice(v), kShare);
    voice(v).rest();
  }
  void part(std::size_t v) {
    voice(v).skip(10000);
    for (auto& sum : sums_[v]) sum->add(voice(v), -kShare);
    voice(v).wake();
  }
  void drive(std::size_t v) {
    const synth::Force force{voice(v).amplitudes().re, out_.data()};
    static_cast<void>(voice(v).render_late(samples_.data(), kChunkFrames, std::span<const synth::Force>(&force, 1)));
    voice(v).merge_late();
  }
  void survey(std::size_t v) { voice(v).count_levels(levels_, 0, kFloor); }
  void apply(std::size_t v, synth::Level threshold) {
    std::size_t allowance = std::numeric_limits<std::size_t>::max();
    voice(v).set_threshold(threshold);
    voice(v).apply_threshold(allowance, false);
  }
  void forget() { levels_.clear(); }

 private:
  static synth::verb::Strike blow() { return {{0.05, 0.02, 0.03}, {1, 2, 3}, 1e-4}; }

  std::vector<std::unique_ptr<synth::Voice>> voices_;
  std::vector<std::array<std::unique_ptr<synth::ModeStates>, kSums>> sums_;
  synth::ChannelSums sums_of_chunk_;
  synth::LevelHistogram levels_;
  std::array<double, kChunkFrames> out_{}, samples_{};
};

}  // namespace

void measure_budget(const Settings& settings, const Sink& sink) {
  Workshop shop;
  const auto nothing = [](std::size_t) {};
  const auto again = [&](std::size_t v) { shop.ring(v); };
  double unit_ns = 0;
  const auto tell = [&](const char* who, const auto& prepare, const auto& work) {
    Row row{.part = "budget", .who = who, .modes = kModes, .objects = kVoices, .block = kChunkFrames};
    const double each_ns = shop.time(settings.quick, prepare, work);
    if (unit_ns == 0) unit_ns = each_ns;
    row.mean_us = 1e-3 * each_ns * kModes;
    row.ratio = each_ns / unit_ns;
    sink(row);
  };
  tell("moments", again, [&](std::size_t v) { shop.render_moments(v); });
  tell("tables", again, [&](std::size_t v) { shop.render(v); });
  tell("strike", again, [&](std::size_t v) { shop.strike(v); });
  tell("shared strike", again, [&](std::size_t v) { shop.strike_in_group(v); });
  tell("share", again, [&](std::size_t v) { shop.share(v); });
  tell("part", again, [&](std::size_t v) { shop.part(v); });
  tell("pulse", again, [&](std::size_t v) { shop.drive(v); });
  shop.ring();
  shop.forget();
  tell("survey", nothing, [&](std::size_t v) { shop.survey(v); });
  const auto apply_and_render = [&](synth::Level threshold) {
    return [&shop, threshold](std::size_t v) { shop.apply(v, threshold), shop.render_moments(v); };
  };
  tell("look", again, [&](std::size_t v) { shop.apply(v, kLowThreshold); });
  tell("leave", again, apply_and_render(kNonePasses));
  const auto mute = [&](std::size_t v) { shop.ring(v), shop.apply(v, kNonePasses), shop.render_moments(v); };
  tell("enter", mute, apply_and_render(kAllPass));
}

}  // namespace ringdown::bench
