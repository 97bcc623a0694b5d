#include "engine/synth/modes/fade_out.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ringdown::synth {

FadeOut::FadeOut(const ModeTable& table) : states_(table), all_groups_(table.groups()) {
  std::iota(all_groups_.begin(), all_groups_.end(), 0);
}

double FadeOut::level() const REALTIME {
  const double left = static_cast<double>(left_) / static_cast<double>(frames_);
  if (nepers_ == 0) return left;
  return std::exp(-nepers_ * (1 - left)) * std::min(1.0, static_cast<double>(left_) / static_cast<double>(kMinFrames));
}

void FadeOut::begin(StateArray& from, const Fading& fade) REALTIME {
  const double before = level();
  double *re = states_.re(), *im = states_.im();
  for (std::size_t i = 0; i < states_.table().columns(); ++i) {
    re[i] = before * re[i] + from.re()[i];
    im[i] = before * im[i] + from.im()[i];
  }
  from.clear();
  const bool abrupt = fade.nepers > 0 && fade.frames < kMinFrames;
  left_ = frames_ = std::max(fade.frames, abrupt ? std::size_t{1} : kMinFrames);
  nepers_ = abrupt ? 0 : fade.nepers;
}

bool FadeOut::move_from(FadeOut& other, const modal::ModeTransfer* change) REALTIME {
  const bool left = change == nullptr && states_.move_from(other.states_);
  if (change != nullptr) states_.move_from(other.states_, *change);
  const double ratio = states_.table().sample_rate_hz() / other.states_.table().sample_rate_hz();
  const auto scaled = [ratio](std::size_t frames)
                          REALTIME { return static_cast<std::size_t>(std::ceil(static_cast<double>(frames) * ratio)); };
  frames_ = scaled(other.frames_);
  left_ = std::min(scaled(other.left_), frames_);
  nepers_ = other.nepers_;
  return left;
}

bool FadeOut::render(double* out, std::size_t frames) REALTIME {
  double sum[kChunkFrames] = {};
  ActiveGroups all{all_groups_.data(), all_groups_.size()};
  const bool sane = render_modes(states_.for_kernel(frames), all, kKeepAllGroups, sum, frames);
  add_faded(sum, out, frames);
  left_ -= std::min(frames, left_);
  if (left_ == 0) states_.clear();
  return sane;
}

void FadeOut::feel(const Probes& probes, std::size_t frames) REALTIME {
  for (const Probes::One& probe : probes.all()) {
    double sum[kChunkFrames] = {};
    probes.ring(probe, states_, {all_groups_.data(), all_groups_.size()}, sum, frames);
    add_faded(sum, probe.to, frames);
  }
}

void FadeOut::add_faded(const double* samples, double* out, std::size_t frames) const REALTIME {
  std::size_t left = left_;
  if (nepers_ == 0) {
    for (std::size_t n = 0; n < frames && left > 0; ++n, --left) {
      out[n] += samples[n] * static_cast<double>(left) / static_cast<double>(frames_);
    }
    return;
  }
  const double each = std::exp(-nepers_ / static_cast<double>(frames_));
  double fallen = std::exp(-nepers_ * static_cast<double>(frames_ - left) / static_cast<double>(frames_));
  for (std::size_t n = 0; n < frames && left > 0; ++n, --left, fallen *= each) {
    out[n] += samples[n] * fallen * std::min(1.0, static_cast<double>(left) / static_cast<double>(kMinFrames));
  }
}

void FadeOut::skip(std::size_t frames) REALTIME {
  states_.skip(frames);
  left_ -= std::min(frames, left_);
  if (left_ == 0) states_.clear();
}

void FadeOut::clear() REALTIME {
  states_.clear();
  left_ = 0;
}

}  // namespace ringdown::synth
