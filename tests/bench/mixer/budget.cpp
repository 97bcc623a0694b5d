// What the mixer's time budget counts with: what each kind of work costs for a mode, in units of what moments cost.
#include "engine/synth/desk.h"
#include "engine/synth/voice.h"
#include "tests/bench/mixer/measure.h"
#include "tests/bench/mixer/stage.h"
#include "tests/bench/mixer/timing.h"
#include "tests/support/synthetic_bank.h"

#include <array>
#include <ctime>
#include <limits>

namespace ringdown::bench {
namespace {

using synth::kChunkFrames;

constexpr std::size_t kVoices = 40, kModes = 500, kSums = 2;  // a family's sums: left and right
constexpr double kShare = 0.7, kFloor = 1e-12;

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Voices that ring, each with sums of its own as if it had a family.
class Workshop {
 public:
  Workshop() {
    for (std::uint32_t seed = 0; seed < kVoices; ++seed) {
      auto map = std::make_shared<const modal::StrikeMap>(test::shared(test::random_bank(seed, kModes, 500)));
      auto table = std::make_shared<synth::ModeTable>(std::move(map), modal::MaterialScale{}, kRate);
      table->prepare(kChunkFrames);
      sums_.push_back({std::make_unique<synth::Ringing>(*table), std::make_unique<synth::Ringing>(*table)});
      voices_.push_back(std::make_unique<synth::Voice>(std::move(table)));
    }
    none.at.fill(std::numeric_limits<synth::Level>::max());
    none.hides = strict.hides = true;
    desk_.open(kChunkFrames);
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
    listen(v, plain);
    voice(v).silence();
    static_cast<void>(voice(v).strike(blow()));
    for (auto& sum : sums_[v]) sum->silence(), sum->add(voice(v).amplitudes(), 1);
  }
  synth::Voice& voice(std::size_t v) { return *voices_[v]; }
  std::array<std::unique_ptr<synth::Ringing>, kSums>& sums(std::size_t v) { return sums_[v]; }

  void render_together(std::size_t v) {
    const std::array targets = {synth::MomentTarget{desk_.moments(0), 0.7f},
                                synth::MomentTarget{desk_.moments(1), 0.7f}};
    static_cast<void>(voice(v).render_together(targets, out_.data(), kChunkFrames, kFloor));
  }
  void render(std::size_t v) { static_cast<void>(voice(v).render(out_.data(), kChunkFrames, kFloor)); }
  void strike(std::size_t v) {
    static_cast<void>(voice(v).strike_aside(blow(), kChunkFrames / 2));
    static_cast<void>(voice(v).render_aside(out_.data(), kChunkFrames / 2));
    voice(v).join();
  }
  void strike_in_family(std::size_t v) {
    static_cast<void>(voice(v).find_amplitudes(blow()));
    voice(v).skip(10000);
    voice(v).add(voice(v).amplitudes(), 1);
    voice(v).rest();
    for (auto& sum : sums_[v]) {
      sum->add_aside(voice(v).amplitudes(), kShare, kChunkFrames / 2);
      static_cast<void>(sum->render_aside(out_.data(), kChunkFrames / 2));
      sum->join();
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
    const synth::Force force{voice(v).amplitudes(), out_.data()};
    static_cast<void>(voice(v).drive_aside({&force, 1}, samples_.data(), kChunkFrames));
    voice(v).join();
  }
  void survey(std::size_t v) { voice(v).survey(hearing_, 0, kFloor); }
  void listen(std::size_t v, const synth::Cut& cut) {
    std::size_t most = std::numeric_limits<std::size_t>::max();
    voice(v).listen(cut, 0, most);
  }
  void forget() { hearing_.forget(); }

  synth::Cut plain, strict, none;  // all pass and nobody is asked, all pass, none does

 private:
  static synth::Event blow() {
    return {.point_m = {0.05, 0.02, 0.03}, .impulse_ns = {1, 2, 3}, .contact_time_s = 1e-4};
  }

  std::vector<std::unique_ptr<synth::Voice>> voices_;
  std::vector<std::array<std::unique_ptr<synth::Ringing>, kSums>> sums_;
  synth::Desk desk_;
  synth::Hearing hearing_;
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
  tell("moments", again, [&](std::size_t v) { shop.render_together(v); });
  tell("tables", again, [&](std::size_t v) { shop.render(v); });
  tell("strike", again, [&](std::size_t v) { shop.strike(v); });
  tell("shared strike", again, [&](std::size_t v) { shop.strike_in_family(v); });
  tell("share", again, [&](std::size_t v) { shop.share(v); });
  tell("part", again, [&](std::size_t v) { shop.part(v); });
  tell("pulse", again, [&](std::size_t v) { shop.drive(v); });
  shop.ring();
  shop.forget();
  tell("survey", nothing, [&](std::size_t v) { shop.survey(v); });
  const auto listen_and_render = [&](const synth::Cut& cut) {
    return [&shop, &cut](std::size_t v) { shop.listen(v, cut), shop.render_together(v); };
  };
  tell("listen", again, [&](std::size_t v) { shop.listen(v, shop.strict); });
  tell("go", again, listen_and_render(shop.none));
  const auto hide = [&](std::size_t v) { shop.ring(v), shop.listen(v, shop.none), shop.render_together(v); };
  tell("come back", hide, listen_and_render(shop.plain));
}

}  // namespace ringdown::bench
