// The objects' own levels. Those that share states keep states of their own beside them, which tell as much.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr std::size_t kMostObjectsPerLook = 64, kMostModesPerLook = 2048;

}  // namespace

// Some objects after the last ones, at the end of a chunk.
void Mixer::measure_objects() RINGDOWN_REALTIME {
  std::size_t modes = 0;
  const std::size_t most = std::min(kMostObjectsPerLook, numbers_);
  for (std::size_t n = 0; n < most && modes < kMostModesPerLook; ++n) {
    if (next_measured_ >= numbers_) next_measured_ = 0;
    Reach& reach = reaches_.data()[next_measured_];
    const Object& object = objects_.data()[next_measured_++];
    const auto now = static_cast<float>(reach_of(object, modes));
    reach.now.store(now, std::memory_order_relaxed);
    if (now > reach.since.load(std::memory_order_relaxed)) reach.since.store(now, std::memory_order_relaxed);
  }
}

// Adds to `modes` how many were looked at.
double Mixer::reach_of(const Object& object, std::size_t& modes) const RINGDOWN_REALTIME {
  const double gain = std::abs(object.gain.at(now_));
  if (object.shared) {
    const Family& family = *object.current->table().family;
    if (!family.active || object.lost != family.lost) return 0;
    modes += object.current->table().columns();
    return gain * object.current->reach_at_rest(now_ - object.anchor);
  }
  double sum = 0;
  const auto add = [&](const Voice* voice) RINGDOWN_REALTIME {
    if (!voice || !voice->ringing()) return;
    modes += voice->table().columns();
    sum += voice->reach();
  };
  add(object.current);
  for (const Voice* voice = object.tails; voice; voice = voice->next) add(voice);
  return gain * sum;
}

float Mixer::take_reach(protocol::ObjectNumber object) {
  Reach& reach = reaches_[object];
  const float now = reach.now.load(std::memory_order_relaxed);
  return std::max(now, reach.since.exchange(0, std::memory_order_relaxed));
}

}  // namespace ringdown::synth
