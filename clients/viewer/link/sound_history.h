// The last two seconds of the mix, assembled from the pieces that /notify.sound brings. [one thread]
#pragma once

#include "protocol/reply.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::viewer {

class SoundHistory {
 public:
  static constexpr double kLength_s = 2;
  static constexpr double kMaxRate_hz = 768000;  // a piece at a higher rate is ignored

  // Appends a piece. Frames missing between the last piece and this one are filled with silence and counted. A piece
  // that repeats or precedes stored frames is ignored. If it lies more than half a second back, or has another sample
  // rate, the history restarts with it.
  void take(const protocol::NotifySound& piece);

  void restart();

  // Writes the last `frames` frames, oldest first, into both vectors, which are resized; silence before the beginning.
  void last(std::size_t frames, std::vector<float>& left, std::vector<float>& right) const;

  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }  // 0: no piece has arrived
  [[nodiscard]] std::size_t capacity() const { return left_.size(); }      // frames in kLength_s
  // Returns how many frames have arrived since the history started, gaps included.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }
  [[nodiscard]] std::uint64_t missing_frames() const { return missing_frames_; }

 private:
  void begin(const protocol::NotifySound& piece);
  void append(float left, float right);
  void append_silence(std::uint64_t frames);

  double sample_rate_hz_ = 0;
  std::vector<float> left_, right_;  // ring buffers: frame n is at n modulo their size
  std::uint64_t end_ = 0, gaps_ = 0, missing_frames_ = 0;
  std::int32_t next_frame_ = 0;  // number of the next frame, in the daemon's count
};

}  // namespace ringdown::viewer
