// Hands the mix to threads that show or capture it: while the tap is watched, the audio thread puts pieces into a ring,
// and another thread takes them out. A piece that finds the ring full is dropped; frame numbers then show a gap.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/synth/events/event.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>

namespace ringdown::synth {

inline constexpr std::size_t kTappedFrames = 256;  // maximum length of a piece
inline constexpr std::size_t kMaxTapped = 512;     // waiting pieces: 2.7 s in blocks of 256 frames at 48 kHz
inline constexpr std::size_t kMaxSpare = 8192;     // maximum block that can be watched if no output takes the mix

class SoundTap {
 public:
  struct Piece {
    Frame frame = 0;  // number of the piece's first frame
    double sample_rate_hz = 0;
    std::size_t frames = 0;
    std::array<float, 2 * kTappedFrames> samples;  // left right left right ...
  };

  // The ring is made when somebody watches for the first time. [any but audio]
  void watch(bool on);
  [[nodiscard]] bool watched() const REALTIME { return watched_.load(std::memory_order_acquire); }

  // Returns false if the tap is watched and put() would drop a piece of a block of `frames` that an empty ring would
  // hold. [audio]
  [[nodiscard]] bool takes(std::size_t frames) const REALTIME;

  // Puts a block whose first frame is `frame`. [audio]
  void put(Frame frame, double sample_rate_hz, const float* left, const float* right, std::size_t frames) REALTIME;

  // Returns the oldest piece, valid until pop(), or null if there is none. [one thread that is not audio]
  [[nodiscard]] const Piece* front() const {
    const SpscRing<Piece>* const ring = ring_.load(std::memory_order_acquire);
    return ring ? ring->front() : nullptr;
  }
  void pop() { ring_.load(std::memory_order_acquire)->pop(); }

 private:
  std::atomic<bool> watched_{false};
  std::once_flag made_;
  std::unique_ptr<SpscRing<Piece>> owned_;
  std::atomic<SpscRing<Piece>*> ring_{nullptr};  // owned_; never null while somebody watches
};

}  // namespace ringdown::synth
