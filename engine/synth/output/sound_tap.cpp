#include "engine/synth/output/sound_tap.h"

#include <algorithm>

namespace ringdown::synth {

bool SoundTap::takes(std::size_t frames) const RINGDOWN_REALTIME {
  const std::size_t pieces = (frames + kTappedFrames - 1) / kTappedFrames;
  return !watched() || ring_.size() == 0 || ring_.size() + pieces <= ring_.capacity();
}

void SoundTap::put(Frame frame, double sample_rate_hz, const float* left, const float* right,
                   std::size_t frames) RINGDOWN_REALTIME {
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
    if (!ring_.push(piece)) return;
  }
}

}  // namespace ringdown::synth
