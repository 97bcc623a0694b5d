// Long runs: a million strikes, a day, and ten thousand strikes a second.
#include "tests/stress/company.h"
#include "tests/stress/exact_voice.h"
#include "tests/stress/mixer_table.h"
#include "tests/synth/mode_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr double kCentreGain = std::numbers::sqrt2 / 2;
const double kLn1000 = std::log(1000.0);

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

std::string span_of(double seconds) {
  return seconds < 3600 ? text("%g min", seconds / 60) : text("%g h", seconds / 3600);
}

// A mixer whose sound is looked at and not kept.
class Listener {
 public:
  explicit Listener(std::size_t block) : left(block), right(block) {}

  // Renders `frames`, a block at a time.
  void pass(std::size_t frames) {
    for (std::size_t done = 0; done < frames; done += left.size()) {
      block(std::min(left.size(), frames - done));
    }
  }
  void block(std::size_t frames) {
    mixer.render(std::span(left).first(frames), std::span(right).first(frames));
    const auto finite = [](float sample) { return std::isfinite(sample); };
    all_finite =
        all_finite && std::all_of(left.begin(), left.end(), finite) && std::all_of(right.begin(), right.end(), finite);
  }
  [[nodiscard]] Frame now() const { return mixer.counters().frames; }

  Mixer mixer{kRate};
  std::vector<float> left, right;  // the last block
  bool all_finite = true;
};

Samples scaled(Samples samples, double gain) {
  for (double& sample : samples) sample *= gain;
  return samples;
}

// Strikes of any size, 1 to 63 frames apart; the sound of the last 256 frames against the superposition of all.
double error_after_strikes(std::size_t count, bool moments) {
  std::mt19937 random(17);
  const Map map = map_of(single_mode_bank(1234.5, kLn1000 / 600));
  ExactVoice exact(map, kRate);
  Listener heard(256);
  set(heard.mixer, &MixerSettings::floor_db, kNever);
  EXPECT_TRUE(heard.mixer.install(0, voice_of(map), Mixer::Install::replace));
  if (moments) keep_company(heard.mixer);
  Frame frame = 2000;
  for (std::size_t struck = 0; struck < count;) {
    for (; struck < count && frame < heard.now() + 8192; ++struck, frame += 1 + static_cast<Frame>(random() % 63)) {
      const double size = std::pow(10.0, uniform(random, -9, 3));
      const Event strike = vertex_strike_at(frame, 0, 0, {0, 0, random() % 2 == 0 ? size : -size});
      EXPECT_TRUE(heard.mixer.push(Producer::control, strike));
      exact.strike(strike);
    }
    heard.pass(8192);
  }
  heard.pass(8192);
  const Frame first = heard.now();
  heard.pass(256);
  EXPECT_EQ(heard.mixer.counters().strikes, count + (moments ? 1 : 0));
  EXPECT_EQ(heard.mixer.counters().late, 0u);
  EXPECT_TRUE(heard.all_finite);
  return relative_error_db(to_doubles(heard.left), scaled(exact.samples(first, 256), kCentreGain));
}

// The floats that come out are good for about -150 dB, the kernels for -119 dB (moments.h).
TEST(StressEndurance, AMillionStrikesSuperpose) {
  for (const bool moments : {false, true}) {
    const std::size_t count = long_form() ? 10'000'000 : moments ? 100'000 : 1'000'000;
    const double error = error_after_strikes(count, moments);
    EXPECT_LT(error, -115);
    enter({text("%zu strikes", count),
           text("on one mode, 1e-9 to 1e3 N s, 1 to 63 frames apart%s", moments ? "; moments" : ""),
           text("%.1f dB of the closed form after the last", error), "-115 dB"});
  }
}

// Ten modes whose T60 is an hour to a day.
std::vector<Mode> long_modes() {
  std::vector<Mode> modes;
  const double pitches[] = {1, 20.3, 110, 440.1, 1000.7, 5003, 9999.9, 12007, 19999, 23999};
  for (std::size_t i = 0; i < std::size(pitches); ++i) {
    modes.push_back({pitches[i], 3600 * std::pow(24.0, static_cast<double>(i) / 9), {0.3, -1}});
  }
  return modes;
}

// The kernels alone, whose energy can be read off exactly: chunk by chunk it falls.
TEST(StressEndurance, EnergyNeverRisesInADay) {
  const double seconds = long_form() ? 86400 : 300;
  const auto chunks = static_cast<std::size_t>(seconds * kRate) / kChunkFrames;
  for (const Kernel kernel : {Kernel::direct, Kernel::moments}) {
    Bundle bundle(long_modes(), kRate, kernel);
    std::vector<double> out(kChunkFrames);
    const auto advance = [&] {
      kernel == Kernel::moments ? static_cast<void>(bundle.gather(kChunkFrames)) : bundle.add(out.data(), kChunkFrames);
    };
    std::size_t rises = 0;
    double before = 1e300;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      advance();
      rises += bundle.energy() < before ? 0 : 1;
      before = bundle.energy();
    }
    double worst = -400;
    const std::vector<Mode> modes = long_modes();
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const Exact exact = exact_state(modes[i], kRate, chunks * kChunkFrames);
      const auto error = static_cast<double>(std::abs(Exact(bundle.state(i)) - exact) / std::abs(exact));
      worst = std::max(worst, 20 * std::log10(error));
    }
    EXPECT_EQ(rises, 0u);
    // omega / (sample rate) is rounded to a double: after a day at 24 kHz, 1.3e10 radians, that is 1e-6 of a radian.
    EXPECT_LT(worst, -110);
    enter({"energy in " + span_of(seconds),
           text("10 modes, T60 1 h to 24 h%s", kernel == Kernel::moments ? "; moments" : ""),
           text("%zu chunks, energy rose in %zu; states %.1f dB of the closed form at the end", chunks, rises, worst),
           "0 rises; -110 dB"});
  }
}

// Without damping, energy keeps to within what rounding can do: two products and a sum in each chunk.
TEST(StressEndurance, UndampedModesRingForADay) {
  const double seconds = long_form() ? 86400 : 300;
  const auto chunks = static_cast<std::size_t>(seconds * kRate) / kChunkFrames;
  std::vector<Mode> modes = long_modes();
  for (Mode& mode : modes) mode.t60_s = std::numeric_limits<double>::infinity();
  Bundle bundle(std::move(modes), kRate, Kernel::direct);
  std::vector<double> out(kChunkFrames);
  bundle.add(out.data(), kChunkFrames);
  const double start = bundle.energy();
  for (std::size_t chunk = 1; chunk < chunks; ++chunk) bundle.add(out.data(), kChunkFrames);
  const double drift = std::abs(bundle.energy() / start - 1);
  const double allowed = 4 * std::numeric_limits<double>::epsilon() * static_cast<double>(chunks);
  EXPECT_LT(drift, allowed);
  enter({span_of(seconds) + " undamped", "10 modes that never decay", text("energy within %.1e", drift),
         text("%.1e", allowed)});
}

// The mixer itself, in blocks of 8192: strikes every hour, and something always rings.
TEST(StressEndurance, TheSoundOfADayStaysTheClosedForm) {
  const double hours = long_form() ? 24 : 0.1, strike_every_s = long_form() ? 3600 : 60;
  constexpr std::size_t kBlock = 8192;
  modal::Bank bank = random_bank(8, 8, 12);
  const std::vector<Mode> modes = long_modes();
  for (std::size_t m = 0; m < 8; ++m) {
    bank.frequency_hz[m] = modes[m + 1].frequency_hz;
    bank.decay_per_s[m] = kLn1000 / modes[m + 1].t60_s;
  }
  const Map map = map_of(std::move(bank));
  ExactVoice exact(map, kRate);
  Listener heard(kBlock);
  ASSERT_TRUE(heard.mixer.install(0, voice_of(map), Mixer::Install::replace));
  const auto end = static_cast<Frame>(hours * 3600 * kRate), period = static_cast<Frame>(strike_every_s * kRate);
  double worst = -400, closest = 0;
  std::size_t over = 0, looks = 0;
  std::uint64_t strikes = 0;
  for (Frame next = 0; heard.now() < end;) {
    const Frame now = heard.now();
    const bool struck = next < now + static_cast<Frame>(kBlock);
    if (struck) {
      const Event strike = vertex_strike_at(next, 0, static_cast<std::uint32_t>(strikes++ % 12), {0.1, 0.2, -0.1});
      ASSERT_TRUE(heard.mixer.push(Producer::control, strike));
      exact.strike(strike);
      next += period;
    }
    heard.block(kBlock);
    if (struck) continue;
    const double bound = kCentreGain * exact.loudness(now), loudest = static_cast<double>(heard.mixer.counters().peak);
    over += loudest <= bound * (1 + 1e-5) ? 0 : 1;
    closest = std::max(closest, loudest / bound);
    if (looks++ % 350 != 0) continue;  // once a minute
    const Samples wanted = scaled(exact.samples(now, 256), kCentreGain);
    worst = std::max(worst, relative_error_db(to_doubles(std::span(heard.left).first(256)), wanted));
  }
  EXPECT_EQ(over, 0u);
  EXPECT_TRUE(heard.all_finite);
  EXPECT_EQ(heard.mixer.counters().strikes, strikes);
  EXPECT_GT(heard.mixer.counters().ringing_modes, 0u);
  EXPECT_LT(worst, -110);
  enter({span_of(3600 * hours) + " of sound", text("8 modes, blocks of 8192, a strike every %g s", strike_every_s),
         text("%.1f dB of the closed form, each minute; %zu blocks above the falling sum of amplitudes, loudest %.4f "
              "of it",
              worst, over, closest),
         "-110 dB; 0 blocks"});
}

// Each strike on its frame, and the sum of all of them exact at the end.
TEST(StressEndurance, TenThousandStrikesASecondOnAThousandObjects) {
  constexpr ObjectNumber kObjects = 1000;
  constexpr std::size_t kModes = 10, kBlock = 128;
  const int seconds = long_form() ? 20 : 2;
  std::mt19937 random(23);
  std::vector<ExactVoice> exact;
  Listener heard(kBlock);
  set(heard.mixer, &MixerSettings::floor_db, kNever);
  for (ObjectNumber object = 0; object < kObjects; ++object) {
    const Map map = map_of(random_bank(object, kModes, 12));
    ASSERT_TRUE(heard.mixer.install(object, voice_of(map), Mixer::Install::replace));
    exact.emplace_back(map, kRate);
  }
  const std::uint64_t count = 10000 * static_cast<std::uint64_t>(seconds);
  std::uint64_t pushed = 0;
  std::uint32_t max_modes = 0;
  // In no order within a block, on any object.
  while (pushed < count) {
    std::vector<Event> strikes;
    const auto due =
        std::min(count, static_cast<std::uint64_t>(heard.now() + static_cast<Frame>(kBlock)) * 10000 / 48000);
    for (; pushed < due; ++pushed) {
      const Frame frame = heard.now() + static_cast<Frame>(random() % kBlock);
      const Vec3 impulse{uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1)};
      const auto object = static_cast<ObjectNumber>(random() % kObjects);
      const auto vertex = static_cast<std::uint32_t>(random() % 12);
      strikes.push_back(vertex_strike_at(frame, object, vertex, impulse, uniform(random, 0, 2e-3)));
      ASSERT_TRUE(heard.mixer.push(Producer::control, strikes.back()));
    }
    std::ranges::stable_sort(strikes, {}, &Event::frame);
    for (const Event& strike : strikes) exact[strike.object].strike(strike);
    heard.block(kBlock);
    max_modes = std::max(max_modes, heard.mixer.counters().ringing_modes.load());
  }
  const Frame first = heard.now();
  heard.block(kBlock);
  Samples wanted(kBlock, 0.0);
  for (const ExactVoice& voice : exact) {
    const Samples one = voice.samples(first, kBlock);
    for (std::size_t n = 0; n < kBlock; ++n) wanted[n] += kCentreGain * one[n];
  }
  const MixerCounters& seen = heard.mixer.counters();
  EXPECT_EQ(seen.strikes, count);
  EXPECT_EQ(seen.late, 0u);
  EXPECT_EQ(seen.refused, 0u);
  EXPECT_EQ(seen.not_finite, 0u);
  EXPECT_TRUE(heard.all_finite);
  const double error = relative_error_db(to_doubles(heard.left), wanted);
  EXPECT_LT(error, -110);
  enter({"10,000 strikes a second", text("1,000 objects of 10 modes, %d s, up to %u modes at once", seconds, max_modes),
         text("%llu of %llu played, %llu late; sum of all %.1f dB of the closed form",
              static_cast<unsigned long long>(seen.strikes.load()), static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(seen.late.load()), error),
         "all, 0 late; -110 dB"});
}

}  // namespace
}  // namespace ringdown::synth::test
