// Random scores, of everything that may happen to a mixer, in any order: what comes out is finite, and never louder
// than the modes that sound.
//
// The bound. A mode sounds Re(z p^n) with |p| < 1, so no sample of it exceeds |z|, and |z| only falls but where a
// strike adds to it. An object's gain moves between two values in a straight line, the gain of each channel is at most
// 1, and a fade multiplies with at most 1. So within a block no sample of the mix or a bus exceeds
//   sum over objects of (largest gain in the block) (sum over modes of |z| at its beginning + what strikes in it add),
// with |z| from the closed form, strike by strike. A mode that may have been below the floor may have been put to rest,
// and then a strike cannot cancel what rang: so much is added. Without a strike the bound falls, by itself and for
// ever.
//
// RINGDOWN_STRESS_SEED=n plays the score of that seed alone.
#include "tests/stress/exact_voice.h"
#include "tests/stress/mixer_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

// Each mode is off by at most 1.1e-6 of |z| (moments.h), and float sums round: 1e-5 is far above both.
constexpr double kRounding = 1e-5;

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(random_()) / 4294967296.0; }
  double spread(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }  // evenly by ratio
  std::size_t below(std::size_t count) { return random_() % count; }
  bool chance(double share) { return uniform(0, 1) < share; }

 private:
  std::mt19937 random_;
};

// Pitches from 1 Hz to beyond every Nyquist, T60 from 1 ms to an hour.
modal::Bank wild_bank(std::uint32_t seed, std::size_t modes) {
  modal::Bank bank = random_bank(seed, modes, 12);
  Dice dice(seed);
  for (std::size_t m = 0; m < modes; ++m) {
    bank.frequency_hz[m] = dice.spread(1, 100e3);
    bank.decay_per_s[m] = std::log(1000.0) / dice.spread(1e-3, 3600);
  }
  return bank;
}

// Small banks are the most frequent; two have enough modes to be summed by moments.
const std::vector<Map>& maps() {
  static const std::vector<Map> kMaps = [] {
    std::vector<Map> made;
    for (const std::size_t modes : {1, 2, 7, 8, 9, 17, 30, 45}) made.push_back(map_of(random_bank(1, modes, 12)));
    for (const std::size_t modes : {1, 5, 12, 24, 40}) made.push_back(map_of(wild_bank(2, modes)));
    made.push_back(map_of(random_bank(3, 420, 12)));
    made.push_back(map_of(wild_bank(4, 600)));
    return made;
  }();
  return kMaps;
}

// A voice, and what of it fades: a bound of the fade's sound, and where it began.
struct BoundedVoice {
  ExactVoice voice;
  double fading = 0;
  Frame fade_begin = 0, fade_frames = 1;

  [[nodiscard]] double fade_at(Frame frame) const {
    const double done = static_cast<double>(frame - fade_begin) / static_cast<double>(fade_frames);
    return done < 1 ? fading * (1 - done) : 0;
  }
  [[nodiscard]] double at(Frame frame) const { return voice.loudness(frame) + fade_at(frame); }
  void fade(Frame frame, Frame frames) {
    fading = at(frame);
    fade_begin = frame;
    fade_frames = std::max(frames, static_cast<Frame>(FadeOut::kMinFrames));
    voice.silence();
  }
};

// How loud an object can be.
class BoundedObject {
 public:
  void install(ExactVoice voice, Mixer::Install how, Frame now) {
    BoundedVoice next{std::move(voice)};
    if (current_ && how == Mixer::Install::retune) {
      next.voice.take_over(current_->voice, now);
      next.fading = current_->fading, next.fade_begin = current_->fade_begin;
      next.fade_frames = current_->fade_frames;
      fade_what_is_left(next.voice, now);
    } else if (current_) {
      tails_.push_back(*current_);
    }
    current_ = std::move(next);
  }
  void remove(Frame now) {
    fade(now, FadeOut::kMinFrames);
    if (current_) tails_.push_back(*current_);
    current_.reset();
    min_gain_ = 1;  // its number starts afresh, with gain 1, once the tails have died away
  }
  void apply(const Event& event, double rate, double floor) {
    const auto frames_of = [&](double ramp_s) { return static_cast<Frame>(std::max(ramp_s, 0.005) * rate) + 1; };
    if (const auto* set = event.verb.get_if<verb::Gain>()) {
      gain_ = std::max(gain(event.frame), std::abs(set->gain));
      settled_gain_ = std::abs(set->gain);
      settled_ = event.frame + frames_of(set->ramp_s);
    } else if (const auto* clear = event.verb.get_if<verb::Clear>()) {
      fade(event.frame, frames_of(clear->ramp_s));
    } else if (!event.verb.holds<verb::Pan>() && plays(event)) {
      struck_ += current_->voice.strike(event, floor);
    }
    block_gain_ = std::max(block_gain_, gain(event.frame));
  }
  void begin_block(Frame frame) {
    struck_ = current_ ? current_->at(frame) : 0;
    for (const BoundedVoice& tail : tails_) struck_ += tail.at(frame);
    block_gain_ = gain(frame);
  }
  [[nodiscard]] double bound() const { return block_gain_ * struck_; }
  [[nodiscard]] const ExactVoice* voice() const { return current_ ? &current_->voice : nullptr; }

 private:
  // Of the modes that a retuned voice does not have: they, and what of them fades already, fade from here on.
  void fade_what_is_left(const ExactVoice& taken, Frame now) {
    if (!current_->voice.has_more_than(taken)) return;
    BoundedVoice left = *current_;
    left.fade(now, FadeOut::kMinFrames);
    left.fading = current_->voice.loudness(now) - taken.loudness(now) + current_->fade_at(now);
    tails_.push_back(left);
  }
  [[nodiscard]] bool plays(const Event& event) const {
    const auto* vertex = event.verb.get_if<verb::StrikeVertex>();
    return current_ && (!vertex || vertex->vertex < current_->voice.map()->bank().point_count());
  }
  [[nodiscard]] double gain(Frame frame) const { return std::max(min_gain_, frame < settled_ ? gain_ : settled_gain_); }
  void fade(Frame frame, Frame frames) {
    if (current_) current_->fade(frame, frames);
    for (BoundedVoice& tail : tails_) tail.fade(frame, frames);
  }

  std::optional<BoundedVoice> current_;
  std::vector<BoundedVoice> tails_;
  double gain_ = 1, settled_gain_ = 1, min_gain_ = 0;
  Frame settled_ = 0;
  double struck_ = 0, block_gain_ = 1;  // of the block
};

struct Totals {
  std::uint64_t scores = 0, strikes = 0, changes = 0, frames = 0;
  double closest = 0;       // |sample| / bound, where there is one to speak of
  std::uint64_t quiet = 0;  // scores that were heard to their end
};

// One score, played and bounded.
class Score {
 public:
  Score(std::uint32_t seed, Totals& totals)
      : dice_(seed), rate_(pick({44100, 48000, 88200, 96000, 176400, 192000})), mixer_(rate_), totals_(totals) {
    objects_.resize(1 + dice_.below(5));
    if (dice_.chance(0.3)) {
      const double floor_db = dice_.uniform(40, 180);
      floor_ = std::pow(10.0, -floor_db / 20);
      set(mixer_, &MixerSettings::floor_db, floor_db);
    }
    busy_ = dice_.spread(0.3, 10);
    shares_ = dice_.chance(0.5);
  }

  void play() {
    for (ObjectNumber object = 0; object < objects_.size(); ++object) install(object, Mixer::Install::replace);
    const std::size_t blocks = 5 + dice_.below(40);
    for (std::size_t i = 0; i < blocks && !testing::Test::HasFailure(); ++i) {
      if (dice_.chance(0.1)) change_a_voice();
      push_events(dice_.below(1 + static_cast<std::size_t>(busy_)));
      render(block_);
      next_block();
    }
    while (!pending_.empty() && !testing::Test::HasFailure()) render(8192);
    const MixerCounters& seen = mixer_.counters();
    EXPECT_EQ(seen.strikes + seen.refused, strikes_pushed_) << "strikes are lost or played twice";
    EXPECT_EQ(seen.not_finite, 0u);
    if (dice_.chance(0.3)) die_away();
    ++totals_.scores;
    totals_.strikes += seen.strikes;
    totals_.frames += static_cast<std::uint64_t>(now_);
  }

 private:
  double pick(std::initializer_list<double> values) { return values.begin()[dice_.below(values.size())]; }

  void next_block() { block_ = dice_.chance(0.3) ? block_ : static_cast<std::size_t>(dice_.spread(1, 8193)); }

  void install(ObjectNumber object, Mixer::Install how) {
    const ExactVoice* ringing = objects_[object].voice();
    const bool retune = how == Mixer::Install::retune && ringing != nullptr;
    const Map map = retune ? ringing->map() : maps()[dice_.below(maps().size())];
    modal::MaterialScale material;
    if (dice_.chance(0.5)) {
      material = {dice_.spread(1e-2, 1e4), dice_.spread(1e-2, 1e4), dice_.spread(0.1, 10), dice_.spread(0.01, 100)};
    }
    auto voice = shares_ ? std::make_unique<Voice>(mixer_.table_for(map, material)) : voice_of(map, rate_, material);
    ASSERT_TRUE(mixer_.install(object, std::move(voice), how));
    objects_[object].install(ExactVoice(map, rate_, material), how, now_);
  }

  void change_a_voice() {
    const auto object = static_cast<ObjectNumber>(dice_.below(objects_.size()));
    ++totals_.changes;
    if (dice_.chance(0.3)) {
      const std::size_t bus = dice_.below(kBuses + 1);
      ASSERT_TRUE(mixer_.assign(object, bus < kBuses ? std::optional(bus) : std::nullopt));
    } else if (dice_.chance(0.2)) {
      ASSERT_TRUE(mixer_.remove(object));
      objects_[object].remove(now_);
    } else {
      install(object, dice_.chance(0.5) ? Mixer::Install::retune : Mixer::Install::replace);
    }
    mixer_.collect();
  }

  Event random_event() {
    const auto object = static_cast<ObjectNumber>(dice_.below(objects_.size()));
    const auto reach = static_cast<double>(block_);
    const Frame frame = now_ + static_cast<Frame>(dice_.uniform(-0.1 * reach, 1.5 * reach));
    const double kind = dice_.uniform(0, 1), ramp_s = dice_.chance(0.3) ? 0 : dice_.spread(1e-4, 10);
    if (kind < 0.10) return gain_at(frame, object, dice_.chance(0.2) ? 0 : dice_.spread(1e-6, 1e6), ramp_s);
    if (kind < 0.15) return gain_at(frame, object, -dice_.spread(1e-3, 1e3), ramp_s);
    if (kind < 0.25) return pan_at(frame, object, dice_.uniform(-1, 1) * dice_.spread(1, 100));
    if (kind < 0.30) return clear_at(frame, object, ramp_s);
    const double size = dice_.spread(1e-9, 1e6);
    const Vec3 impulse{size * dice_.uniform(-1, 1), size * dice_.uniform(-1, 1), size * dice_.uniform(-1, 1)};
    const double contact_s = dice_.chance(0.3) ? 0 : dice_.spread(1e-6, 1);
    const Vec3 point{dice_.uniform(-2, 2), dice_.uniform(-2, 2), dice_.uniform(-2, 2)};
    if (!dice_.chance(0.5)) return strike_at(frame, object, impulse, contact_s, point);
    const verb::StrikeVertex strike{static_cast<std::uint32_t>(dice_.below(14)), impulse, contact_s};
    return {frame, object, strike};
  }

  void push_events(std::size_t count) {
    std::array<std::vector<Event>, static_cast<std::size_t>(Producer::kCount)> pushed;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t producer = dice_.below(pushed.size());
      Event event = random_event();
      ASSERT_TRUE(mixer_.push(static_cast<Producer>(producer), event));
      strikes_pushed_ += excites(event);
      event.frame = std::max(event.frame, now_);
      pushed[producer].push_back(event);
    }
    for (const auto& events : pushed) pending_.insert(pending_.end(), events.begin(), events.end());
    std::ranges::stable_sort(pending_, {}, &Event::frame);
  }

  // What the samples of the coming block may reach.
  double bound_of(std::size_t frames) {
    for (BoundedObject& object : objects_) object.begin_block(now_);
    std::size_t due = 0;
    for (; due < pending_.size() && pending_[due].frame < now_ + static_cast<Frame>(frames); ++due) {
      objects_[pending_[due].object].apply(pending_[due], rate_, floor_);
    }
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(due));
    double sum = 0;
    for (const BoundedObject& object : objects_) sum += object.bound();
    return sum;
  }

  // The mix nine times in ten, and each bus every other time; zeros stay where nobody listens.
  Outputs choose_outputs(std::size_t frames) {
    for (std::vector<float>& channel : channels_) channel.assign(frames, 0.0f);
    Outputs outputs = dice_.chance(0.9) ? Outputs(channels_[0].data(), channels_[1].data()) : Outputs();
    for (std::size_t bus = 0; bus < kBuses; ++bus) {
      if (dice_.chance(0.5)) outputs.listen_to_bus(bus, channels_[2 + bus].data());
    }
    return outputs;
  }

  void render(std::size_t frames) {
    const double bound = bound_of(frames);
    mixer_.render(choose_outputs(frames), frames);
    double loudest = 0;
    for (const std::vector<float>& channel : channels_) {
      for (const float sample : channel) {
        if (!std::isfinite(sample)) {
          ADD_FAILURE() << "not finite in the block from frame " << now_;
          return;
        }
        loudest = std::max(loudest, std::abs(static_cast<double>(sample)));
      }
    }
    EXPECT_LE(loudest, bound * (1 + kRounding)) << "in the block from frame " << now_;
    if (bound > 1e-6) totals_.closest = std::max(totals_.closest, loudest / bound);
    now_ += static_cast<Frame>(frames);
  }

  // After the last event nothing may wake.
  void die_away() {
    std::uint32_t ringing = ~0u;
    for (int i = 0; i < 40 && ringing > 0 && !testing::Test::HasFailure(); ++i) {
      render(8192);
      const std::uint32_t modes = mixer_.counters().ringing_modes;
      if (!shares_) {
        EXPECT_LE(modes, ringing) << "modes woke without a strike";
      }
      ringing = modes;
    }
    if (mixer_.counters().ringing_voices > 0) return;
    ++totals_.quiet;
    render(8192);
    EXPECT_EQ(mixer_.counters().peak, 0.0f);
  }

  Dice dice_;
  bool shares_ = false;  // objects of one bank share states; who joins others wakes what rests
  double rate_;
  Mixer mixer_;
  Totals& totals_;
  std::vector<BoundedObject> objects_;
  std::vector<Event> pending_;  // by frame, and in the order in which the mixer takes them
  static constexpr std::size_t kBuses = 3;
  std::array<std::vector<float>, 2 + kBuses> channels_;  // of the last block
  std::size_t block_ = 64;
  double busy_ = 1;
  double floor_ = 1e-6;
  std::uint64_t strikes_pushed_ = 0;
  Frame now_ = 0;
};

TEST(StressScores, AnyOrderOfAnythingStaysFiniteAndBelowTheSumOfItsModes) {
  const char* given = std::getenv("RINGDOWN_STRESS_SEED");
  const std::uint32_t first = given ? static_cast<std::uint32_t>(std::strtoul(given, nullptr, 10)) : 1;
  const std::uint32_t count = given ? 1 : long_form() ? 30000 : 400;
  Totals totals;
  for (std::uint32_t seed = first; seed - first < count && !HasFailure(); ++seed) {
    SCOPED_TRACE("play this score again with RINGDOWN_STRESS_SEED=" + std::to_string(seed));
    Score(seed, totals).play();
  }
  enter({"random scores",
         text("%llu scores, %llu strikes of 1e-9 to 1e6 N s, %llu banks or buses changed or removed, gains to 1e6, "
              "blocks of 1 to "
              "8192, 44.1 to 192 kHz, %.0f million frames",
              static_cast<unsigned long long>(totals.scores), static_cast<unsigned long long>(totals.strikes),
              static_cast<unsigned long long>(totals.changes), 1e-6 * static_cast<double>(totals.frames)),
         text("all finite; loudest sample %.7f of the bound; %llu scores heard until silent", totals.closest,
              static_cast<unsigned long long>(totals.quiet)),
         "1.00001 of the bound"});
}

}  // namespace
}  // namespace ringdown::synth::test
