// The mixer with all its threads at once: the audio thread touches nothing it may not, and no event is lost.
// Run under presets tsan and rtsan as well: they see what these counts cannot.
#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr ObjectNumber kObjects = 6;

// Waits until the audio thread has rendered `frames` more, or shall stop: so that what happens per rendered second does
// not depend on the speed of the machine.
void let_pass(const Mixer& mixer, Frame frames, const std::atomic<bool>& stop) {
  const Frame end = mixer.counters().frames + frames;
  while (mixer.counters().frames < end && !stop) std::this_thread::sleep_for(std::chrono::microseconds(50));
}

// Installs, retunes, removes and collects until told to stop.
void work(Mixer& mixer, const std::vector<Map>& maps, const std::atomic<bool>& stop) {
  for (unsigned turn = 0; !stop; ++turn) {
    let_pass(mixer, 500, stop);
    const ObjectNumber object = turn % kObjects;
    const bool room = turn % 7 != 6;
    if (room) {
      const auto how = turn % 3 == 2 ? Mixer::Install::retune : Mixer::Install::replace;
      const modal::MaterialScale material{.stiffness = 1 + 0.1 * (turn % 5)};
      static_cast<void>(mixer.install(object, voice_of(maps[object], mixer.sample_rate_hz(), material), how));
    } else {
      static_cast<void>(mixer.remove(object));
    }
    mixer.collect();
  }
}

// Pushes strikes, gains, pans and clears until told to stop; counts the strikes that were taken.
void produce(Mixer& mixer, Producer producer, const std::atomic<bool>& stop, std::atomic<std::uint64_t>& strikes) {
  for (unsigned turn = 0; !stop; ++turn) {
    const Frame frame = mixer.counters().frames.load() + static_cast<Frame>(turn % 300);
    const ObjectNumber object = turn % kObjects;
    const Event events[] = {strike_at(frame, object, {0.01, 0.02, 0}, 1e-4, {0.1, 0, 0}),
                            vertex_strike_at(frame, object, turn % 8, {0, 0.01, 0}),
                            gain_at(frame, object, 0.5 + 0.1 * (turn % 5), 0.01),
                            pan_at(frame, object, 0.1 * (turn % 7)), clear_at(frame, object)};
    const std::size_t pick = turn % 10 < 7 ? turn % 2 : 2 + turn % 3;
    if (mixer.push(producer, events[pick]) && pick < 2) ++strikes;
    if (turn % 8 == 0) let_pass(mixer, 200, stop);
  }
}

class Band {
 public:
  Band() {
    for (std::uint32_t i = 0; i < kObjects; ++i) {
      modal::Bank bank = random_bank(40 + i, 16, 12);
      for (double& decay : bank.decay_per_s) decay = std::max(decay, 100.0);  // or thousands of tails ring at once
      maps_.push_back(map_of(std::move(bank)));
    }
    for (const Producer producer : {Producer::control, Producer::worker, Producer::scene}) {
      threads_.emplace_back(produce, std::ref(mixer), producer, std::cref(stop_), std::ref(strikes_));
    }
    threads_.emplace_back(work, std::ref(mixer), std::cref(maps_), std::cref(stop_));
  }
  void stop() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  [[nodiscard]] std::uint64_t strikes_taken() const { return strikes_; }

  Mixer mixer{kRate};

 private:
  std::vector<Map> maps_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> strikes_{0};
  std::vector<std::thread> threads_;
};

// Renders until `blocks` blocks have sounded and a thousand strikes were played: silent blocks, of which a fast audio
// thread gets through millions while the others start, do not count. `look` sees every block.
template <class Look>
void play(Mixer& mixer, std::span<float> left, std::span<float> right, int blocks, Look&& look) {
  for (int sounding = 0; sounding < blocks || mixer.counters().strikes < 1000;) {
    mixer.render(left, right);
    sounding += mixer.counters().ringing_voices > 0;
    look();
  }
}

TEST(AudioThread, TheAudioThreadNeverAllocatesLocksOrCallsTheSystemInAHundredThousandBlocks) {
  Band band;
  std::vector<float> left(64), right(64);
  RealtimeViolations seen;
  {
    const RealtimeScope scope;
    play(band.mixer, left, right, 100000, [] {});
    seen = scope.seen();
  }
  band.stop();
  EXPECT_EQ(seen.allocations, 0u) << seen.first;
  EXPECT_EQ(seen.locks, 0u) << seen.first;
  EXPECT_EQ(seen.system_calls, 0u) << seen.first;
}

TEST(AudioThread, EveryStrikeThatWasTakenIsPlayedOrRefused) {
  Band band;
  std::vector<float> left(128), right(128);
  std::size_t not_finite = 0;
  play(band.mixer, left, right, 20000, [&] {
    for (std::size_t n = 0; n < left.size(); ++n) not_finite += !std::isfinite(left[n]) || !std::isfinite(right[n]);
  });
  band.stop();
  for (int block = 0; block < 200; ++block) band.mixer.render(left, right);  // what is still in the rings
  const MixerCounters& counters = band.mixer.counters();
  EXPECT_EQ(counters.strikes + counters.refused, band.strikes_taken());
  EXPECT_EQ(counters.not_finite, 0u);
  EXPECT_EQ(not_finite, 0u);
}

}  // namespace
}  // namespace ringdown::synth::test
