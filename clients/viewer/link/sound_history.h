// The last two seconds of the mix, as /notify.sound tells them piece by piece. [one thread]
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

  // What lies between this piece and the one before is filled with silence, and counted. A piece from more than
  // half a second ago, and another sample rate, begin anew; a later one that was overtaken, or came twice, is ignored.
  void take(const protocol::NotifySound& piece);

  void restart();

  // The last `frames`, oldest first, silence before the beginning; resized to fit.
  void last(std::size_t frames, std::vector<float>& left, std::vector<float>& right) const;

  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }  // 0: nothing was told
  [[nodiscard]] std::size_t capacity() const { return left_.size(); }      // frames in kLength_s
  // Of the first frame that is yet to come; grows by one a frame from the first one told, at 0, gaps included.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }
  [[nodiscard]] std::uint64_t missing_frames() const { return missing_frames_; }

 private:
  void begin(const protocol::NotifySound& piece);
  void append(float left, float right);
  void append_silence(std::uint64_t frames);

  double sample_rate_hz_ = 0;
  std::vector<float> left_, right_;  // rings: frame n is at n modulo their size
  std::uint64_t end_ = 0, gaps_ = 0, missing_frames_ = 0;
  std::int32_t next_frame_ = 0;  // as the daemon counts
};

}  // namespace ringdown::viewer
