#include "engine/synth/output/sound_tap.h"

#include <algorithm>

namespace ringdown::synth {

void SoundTap::watch(bool on) {
  if (on) {
    std::call_once(made_, [this] {
      owned_ = std::make_unique<SpscRing<Piece>>(kMaxTapped);
      ring_.store(owned_.get(), std::memory_order_release);
    });
  }
  watched_.store(on, std::memory_order_release);
}

bool SoundTap::takes(std::size_t frames) const REALTIME {
  if (!watched()) return true;
  const SpscRing<Piece>& ring = *ring_.load(std::memory_order_acquire);
  const std::size_t pieces = (frames + kTappedFrames - 1) / kTappedFrames;
  return ring.size() == 0 || ring.size() + pieces <= ring.capacity();
}

void SoundTap::put(Frame frame, double sample_rate_hz, const float* left, const float* right,
                   std::size_t frames) REALTIME {
  for (std::size_t done = 0; done < frames;) {
    Piece piece;
    piece.frame = frame + static_cast<Frame>(done);
    piece.sample_rate_hz = sample_rate_hz;
    piece.frames = std::min(kTappedFrames, frames - done);
    float* to = piece.samples.data();
    for (const std::size_t end = done + piece.frames; done < end; ++done) {
      *to++ = left[done];
      *to++ = right[done];
    }
    if (!ring_.load(std::memory_order_acquire)->push(piece)) return;
  }
}

}  // namespace ringdown::synth
