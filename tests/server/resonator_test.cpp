// Tubes that are tuned while a bar rings, and the fan in their mouths.
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/state.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {
namespace {

using Complex = std::complex<double>;
using protocol::ObjectRef;
using test::TwoOscillators;

const ObjectRef kBar{.name = "bar"};
// The left channel's sample for a motion of 1 of the tube, or of the bar by a blow of 1 N s.
const double kPerMotion = 2 * std::numbers::pi * 220 * test::kLoudness * test::kBarShape / std::numbers::sqrt2;
constexpr std::size_t kCycles = 654;  // frames of 3 cycles at 220 Hz

class ResonatorTest : public testing::Test {
 protected:
  ResonatorTest() {
    EXPECT_TRUE(modal::write_bank(test::tubed_bank({}), folder_ / "bar.glb"));
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "plain.glb"));
    EXPECT_TRUE(session_.perform(protocol::LoadObject{"bar", (folder_ / "bar.glb").string()}, 0));
  }
  test::Samples render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    session_.rack().collect();
    return test::to_doubles(left);
  }
  [[nodiscard]] synth::Frame now() { return session_.rack().mixer().counters().frames; }
  void strike() { ASSERT_TRUE(session_.play(protocol::Strike{kBar, {{1, 0, 0}, {0, 0, 1}, 0}}, now())); }
  void tune(double cents, double opening = 1) {
    const auto tuned = session_.perform(protocol::SetResonator{kBar, {cents, opening}}, now());
    ASSERT_TRUE(tuned) << tuned.error().message;
  }
  void turn(double rate_hz, double depth) {
    ASSERT_TRUE(session_.play(protocol::SetFan{kBar, {rate_hz, depth}}, now()));
  }

  test::TemporaryFolder folder_;
  Session session_{48000};
};

// Both oscillators, followed in small steps without any modes.
class Followed {
 public:
  explicit Followed(TwoOscillators of) : of_(of) {}
  void tune(double cents) {
    const double ratio = std::exp2(cents / 1200);
    tube_hz_ = ratio * of_.tube_hz, tube_decay_ = std::sqrt(ratio) * of_.tube_decay_per_s;
    pull_ = ratio * of_.pull_rad_s;
  }
  // Returns the largest motion of the tube in the next frames.
  double largest(std::size_t frames) {
    double most = 0;
    for (std::size_t n = 0; n < frames; ++n) {
      most = std::max(most, std::abs(tube));
      constexpr double kStep = 1 / 48000.0;
      // The frame of reference turns with the bar, whose pitch is therefore 0.
      const Complex i(0, 1);
      const Complex bar_turns(-of_.bar_decay_per_s, 0);
      const Complex tube_turns(-tube_decay_, -2 * std::numbers::pi * (tube_hz_ - of_.bar_hz));
      const auto slopes = [&](Complex b, Complex t) {
        return std::pair(bar_turns * b - i * pull_ * t, tube_turns * t - i * pull_ * b);
      };
      const auto [b1, t1] = slopes(bar, tube);
      const auto [b2, t2] = slopes(bar + 0.5 * kStep * b1, tube + 0.5 * kStep * t1);
      bar += kStep * b2, tube += kStep * t2;
    }
    return most;
  }
  Complex bar = 1, tube = 0;

 private:
  TwoOscillators of_;
  double tube_hz_ = of_.tube_hz, tube_decay_ = of_.tube_decay_per_s, pull_ = of_.pull_rad_s;
};

// The sound is that of the tube, which is silent at first. The oracle knows no modes.
TEST_F(ResonatorTest, BarAndTubeGoOnAsTheyMovedWhenTheTubeIsTuned) {
  Followed followed({});
  strike();
  std::vector<double> heard, expected;
  const auto follow = [&](int times) {
    for (int k = 0; k < times; ++k) {
      heard.push_back(test::peak(render(kCycles)));
      expected.push_back(kPerMotion * followed.largest(kCycles));
    }
  };
  follow(15);
  for (const double cents : {-30.0, 20.0, 40.0, 0.0}) {
    tune(cents), followed.tune(cents);
    follow(15);
  }
  // Fields are packed to 1 %, and the bar has a part of the sound.
  const double most = *std::ranges::max_element(expected);
  for (std::size_t k = 0; k < heard.size(); ++k) EXPECT_NEAR(heard[k], expected[k], 0.04 * most) << k;
}

TEST_F(ResonatorTest, AGlideDoesNotClick) {
  strike();
  render(9600);
  const test::Samples still = render(1024);
  const double step = test::largest_step(still, 1, still.size());
  test::Samples glide{still.back()};
  for (int k = 1; k <= 40; ++k) {
    tune(-2 * k);
    const test::Samples more = render(480);
    glide.insert(glide.end(), more.begin(), more.end());
  }
  EXPECT_LT(test::largest_step(glide, 1, glide.size()), 1.2 * step);
}

TEST_F(ResonatorTest, AClosedTubeIsNotHeardAndLaterBlowsFindItSo) {
  tune(0, 0);
  strike();
  const test::Samples sound = render(48000);
  const test::DampedSinusoid bar = test::fit_damped_sinusoid(sound, 48000);
  EXPECT_NEAR(bar.decay_per_s, 0.5, 0.01);
  EXPECT_LT(bar.amplitude(), 0.05 * kPerMotion);
}

// The gain of the tube is 1 - depth (1 - cos) / 2, from an open mouth on.
TEST_F(ResonatorTest, AFanMakesTheTubeSofterAndLouder) {
  const auto sound = [&](bool fan) {
    EXPECT_TRUE(session_.play(protocol::ClearAll{}, now()));
    render(4800);
    if (fan) turn(5, 0.8);
    strike();
    return render(48000);
  };
  constexpr std::size_t kShort = 240;
  const test::Samples plain = sound(false), fanned = sound(true);
  for (std::size_t at = 9600; at + kShort < plain.size(); at += 480) {
    const auto peak = [&](const test::Samples& of) { return test::peak(std::span(of).subspan(at, kShort)); };
    const double t = (static_cast<double>(at) + 0.5 * kShort) / 48000;
    const double gain = 1 - 0.4 * (1 - std::cos(2 * std::numbers::pi * 5 * t));
    EXPECT_NEAR(peak(fanned) / peak(plain), gain, 0.04) << t;
  }
  turn(5, 0);
  render(4800);
  strike();
  EXPECT_GT(test::peak(render(9600)), 0);
}

TEST_F(ResonatorTest, WithoutATubeItIsRefusedAndAFanChangesNothing) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"plain", (folder_ / "plain.glb").string()}, 0));
  const auto refused = session_.perform(protocol::SetResonator{{.name = "plain"}, {10, 1}}, 0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("[[resonator]]"), std::string::npos);
  EXPECT_FALSE(session_.perform(protocol::SetResonator{{.name = "none"}, {10, 1}}, 0));
  const auto sound = [&](double depth) {
    EXPECT_TRUE(session_.play(protocol::ClearAll{}, now()));
    render(4800);
    EXPECT_TRUE(session_.play(protocol::SetFan{{.name = "plain"}, {5, depth}}, now()));
    EXPECT_TRUE(session_.play(protocol::Strike{{.name = "plain"}, {{1, 0, 0}, {0, 0, 1}, 0}}, now()));
    return render(9600);
  };
  const test::Samples without = sound(0);
  EXPECT_LT(test::relative_error_db(sound(1), without), -100);
}

TEST_F(ResonatorTest, RecordingsStatesAndScenesKnowTuningAndFan) {
  std::vector<wire::ScoreEvent> score;
  Recorder recorder(session_.rack(), [&](std::span<const wire::ScoreEvent> events, const std::filesystem::path&) {
    score.assign(events.begin(), events.end());
    return Result<void>();
  });
  tune(-7, 0.5), turn(4, 0.25);
  ASSERT_TRUE(recorder.start(folder_ / "a.osc", now()));
  ASSERT_TRUE(recorder.stop(now()));
  bool tuned = false, fan = false;
  for (const auto& event : score) {
    const auto request = protocol::parse(event.message);
    if (!request) continue;
    if (const auto* set = request->get_if<protocol::SetResonator>()) tuned = set->tuning == modal::TubeTuning{-7, 0.5};
    if (const auto* set = request->get_if<protocol::SetFan>()) fan = set->verb.rate_hz == 4 && set->verb.depth == 0.25;
  }
  EXPECT_TRUE(tuned && fan);
  const auto state = parse_state(to_toml(state_of(session_)), folder_ / "state.toml");
  ASSERT_TRUE(state) << state.error().message;
  Session other(48000);
  ASSERT_TRUE(restore(*state, other, 64));
  const auto restored = *other.rack().find(kBar);
  EXPECT_EQ(tube_tuning(*restored), (modal::TubeTuning{-7, 0.5}));
  EXPECT_EQ(restored->fan_hz, 4);
  EXPECT_EQ(restored->fan_depth, 0.25);
}

}  // namespace
}  // namespace ringdown::session
