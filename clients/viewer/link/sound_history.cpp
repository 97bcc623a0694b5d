#include "clients/viewer/link/sound_history.h"

#include "protocol/wire/message.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr double kMinRate_hz = 1000;
constexpr double kLate_s = 0.5;  // a piece at most this old was overtaken; an older one means that counting restarted

// The number of frames from `from` to `to`, which count modulo kFrameModulus; negative when `to` lies before `from`.
std::int64_t distance(std::int32_t from, std::int32_t to) {
  constexpr std::int64_t half = protocol::kFrameModulus / 2;
  const std::int64_t forward = (std::int64_t{to} - from + 2 * half) % (2 * half);
  return forward < half ? forward : forward - 2 * half;
}

}  // namespace

void SoundHistory::take(const protocol::NotifySound& piece) {
  if (!(piece.sample_rate_hz >= kMinRate_hz && piece.sample_rate_hz <= kMaxRate_hz)) return;
  if (piece.frame < 0 || piece.frame >= protocol::kFrameModulus) return;
  if (piece.sample_rate_hz != sample_rate_hz_) begin(piece);
  const std::int64_t gap = distance(next_frame_, piece.frame);
  if (gap < 0 && static_cast<double>(-gap) < kLate_s * sample_rate_hz_) return;
  if (gap < 0) begin(piece);
  if (gap > 0) {
    ++gaps_;
    missing_frames_ += static_cast<std::uint64_t>(gap);
    append_silence(static_cast<std::uint64_t>(gap));
  }
  const std::vector<float> samples = wire::decode_floats(piece.samples);
  for (std::size_t i = 0; i + 1 < samples.size(); i += 2) append(samples[i], samples[i + 1]);
  next_frame_ = static_cast<std::int32_t>((piece.frame + samples.size() / 2) % protocol::kFrameModulus);
}

void SoundHistory::restart() { *this = {}; }

void SoundHistory::begin(const protocol::NotifySound& piece) {
  restart();
  sample_rate_hz_ = piece.sample_rate_hz;
  left_.assign(static_cast<std::size_t>(std::lround(kLength_s * sample_rate_hz_)), 0);
  right_ = left_;
  next_frame_ = piece.frame;
}

void SoundHistory::append(float left, float right) {
  left_[end_ % left_.size()] = left;
  right_[end_ % right_.size()] = right;
  ++end_;
}

void SoundHistory::append_silence(std::uint64_t frames) {
  const std::uint64_t end_before = end_;
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(frames, left_.size()); ++i) append(0, 0);
  if (frames > left_.size()) {
    std::ranges::fill(left_, 0.0f);
    std::ranges::fill(right_, 0.0f);
    end_ = end_before + frames;
  }
}

void SoundHistory::last(std::size_t frames, std::vector<float>& left, std::vector<float>& right) const {
  left.assign(frames, 0);
  right.assign(frames, 0);
  const std::size_t there = std::min({frames, left_.size(), static_cast<std::size_t>(end_)});
  for (std::size_t i = 0; i < there; ++i) {
    const std::size_t place = (end_ - there + i) % left_.size();
    left[frames - there + i] = left_[place];
    right[frames - there + i] = right_[place];
  }
}

}  // namespace ringdown::viewer
