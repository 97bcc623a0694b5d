// What the mixer costs: modes sustained per core, a strike, silence. Prints, per case, `modes_per_core`: how many modes
// would ring in real time at 48 kHz on the whole of one core. Two references run beside it, so that a figure means
// something on any machine: a plain two-pole filter per mode and exp * sin per sample, as one would first write them;
// `x_two_pole` and `x_closed_form` are the ratios to them.
#include "engine/synth/mixer.h"
#include "tests/support/synthetic_bank.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using namespace ringdown;  // NOLINT: a program of its own

constexpr double kRate = 48000;

// `modes` modes that ring for an hour, so that none leaves during the measurement.
modal::Bank ringing_bank(std::size_t modes) {
  modal::Bank bank = test::random_bank(1, modes, 100);
  for (double& decay : bank.decay_per_s) decay = std::log(1000.0) / 3600;
  return bank;
}

std::shared_ptr<const modal::StrikeMap> map_of(modal::Bank bank) {
  return std::make_shared<const modal::StrikeMap>(test::shared(std::move(bank)));
}

protocol::Event strike_now(protocol::ObjectNumber object) {
  return {.object = object, .point_m = {0.03, 0.05, 0.02}, .impulse_ns = {1, 2, 3}, .contact_time_s = 1e-4};
}

// One two-pole filter per mode, mode by mode, in double: what a compiler makes of the obvious loop.
class TwoPoleFilters {
 public:
  explicit TwoPoleFilters(const modal::Bank& bank) {
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      const double radius = std::exp(-bank.decay_per_s[m] / kRate);
      const double angle = 2 * std::numbers::pi * bank.frequency_hz[m] / kRate;
      filters_.push_back({2 * radius * std::cos(angle), radius * radius, 1, 0});
    }
  }
  void render(std::vector<double>& out) {
    for (Filter& filter : filters_) {
      Filter f = filter;  // in registers: the compiler cannot know that `out` is elsewhere, and would be 3 times slower
      for (double& sample : out) {
        const double y = f.a * f.y1 - f.b * f.y2;
        f.y2 = f.y1;
        f.y1 = y;
        sample += y;
      }
      filter = f;
    }
  }

 private:
  struct Filter {
    double a, b, y1, y2;
  };
  std::vector<Filter> filters_;
};

// exp(-d t) sin(2 pi f t) for every mode and sample.
class ClosedForm {
 public:
  explicit ClosedForm(modal::Bank bank) : bank_(std::move(bank)) {}
  void render(std::vector<double>& out) {
    for (std::size_t m = 0; m < bank_.mode_count(); ++m) {
      const double omega = 2 * std::numbers::pi * bank_.frequency_hz[m], d = bank_.decay_per_s[m];
      for (std::size_t n = 0; n < out.size(); ++n) {
        const double t = start_s_ + static_cast<double>(n) / kRate;
        out[n] += std::exp(-d * t) * std::sin(omega * t);
      }
    }
    start_s_ += static_cast<double>(out.size()) / kRate;
  }

 private:
  modal::Bank bank_;
  double start_s_ = 0;
};

// Modes per core of a reference, measured once in this very run: processor time of a tenth of a second.
template <class Reference>
double modes_per_core_of() {
  constexpr std::size_t kModes = 200, kBlock = 128;
  Reference reference(ringing_bank(kModes));
  std::vector<double> out(kBlock);
  const std::clock_t start = std::clock();
  double blocks = 0;
  for (; std::clock() - start < CLOCKS_PER_SEC / 10; ++blocks) reference.render(out);
  benchmark::DoNotOptimize(out.data());
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return blocks * kModes * kBlock / kRate / seconds;
}

// Modes in real time on one core, from modes x frames done in the measured time, and how many times the references'.
void report(benchmark::State& state, std::size_t modes, std::size_t frames) {
  static const double two_pole = modes_per_core_of<TwoPoleFilters>();
  static const double closed_form = modes_per_core_of<ClosedForm>();
  const double done = static_cast<double>(modes * frames) * static_cast<double>(state.iterations()) / kRate;
  state.counters["modes_per_core"] = benchmark::Counter(done, benchmark::Counter::kIsRate);
  state.counters["x_two_pole"] = benchmark::Counter(done / two_pole, benchmark::Counter::kIsRate);
  state.counters["x_closed_form"] = benchmark::Counter(done / closed_form, benchmark::Counter::kIsRate);
}

struct Stage {
  synth::Mixer mixer{kRate};
  std::vector<float> left, right;

  explicit Stage(std::size_t block) : left(block), right(block) {}
  void install(protocol::ObjectNumber object, const std::shared_ptr<const modal::StrikeMap>& map) {
    static_cast<void>(mixer.install(object, std::make_unique<synth::Voice>(map, modal::MaterialScale{}, kRate),
                                    synth::Mixer::Install::replace));
  }
  void push(const protocol::Event& event) { static_cast<void>(mixer.push(synth::Producer::control, event)); }
  void render() { mixer.render(left, right); }
};

// Ten objects share the modes.
void ringing(benchmark::State& state) {
  const auto modes = static_cast<std::size_t>(state.range(0)), block = static_cast<std::size_t>(state.range(1));
  constexpr std::size_t kObjects = 10;
  Stage stage(block);
  const auto map = map_of(ringing_bank(modes / kObjects));
  for (protocol::ObjectNumber object = 0; object < kObjects; ++object) {
    stage.install(object, map);
    stage.push(strike_now(object));
  }
  stage.render();
  for (auto _ : state) stage.render();
  report(state, modes, block);
  state.SetLabel(synth::kernel_target());
  if (stage.mixer.counters().ringing_modes != modes) state.SkipWithError("not every mode rang to the end");
}
BENCHMARK(ringing)->ArgsProduct({{100, 1000, 10000}, {64, 128, 256, 441}})->ArgNames({"modes", "block"});

template <class Reference>
void reference(benchmark::State& state) {
  const auto modes = static_cast<std::size_t>(state.range(0)), block = static_cast<std::size_t>(state.range(1));
  Reference reference(ringing_bank(modes));
  std::vector<double> out(block);
  for (auto _ : state) {
    std::fill(out.begin(), out.end(), 0.0);
    reference.render(out);
    benchmark::DoNotOptimize(out.data());
  }
  report(state, modes, block);
}
BENCHMARK(reference<TwoPoleFilters>)->Args({1000, 64})->Args({1000, 256})->ArgNames({"modes", "block"});
BENCHMARK(reference<ClosedForm>)->Args({1000, 64})->ArgNames({"modes", "block"});

// A block in which nothing rings, with a full house of objects installed.
void silence(benchmark::State& state) {
  Stage stage(static_cast<std::size_t>(state.range(1)));
  const auto map = map_of(ringing_bank(100));
  for (protocol::ObjectNumber object = 0; object < state.range(0); ++object) stage.install(object, map);
  stage.render();
  for (auto _ : state) stage.render();
}
BENCHMARK(silence)->ArgsProduct({{1, 1000}, {64, 256}})->ArgNames({"objects", "block"});

// One strike, without the mixer around it: find the surface point, excite every mode.
void strike(benchmark::State& state) {
  const auto modes = static_cast<std::size_t>(state.range(0)), points = static_cast<std::size_t>(state.range(1));
  modal::Bank bank = test::random_bank(1, modes, points);
  synth::Voice voice(map_of(std::move(bank)), {}, kRate);
  protocol::Event event = strike_now(0);
  double angle = 0;
  for (auto _ : state) {
    angle += 1.0;
    event.point_m = {0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.05 * std::sin(0.7 * angle)};
    benchmark::DoNotOptimize(voice.strike(event));
  }
}
BENCHMARK(strike)->ArgsProduct({{50, 500}, {100, 1000, 10000}})->ArgNames({"modes", "points"});

}  // namespace
