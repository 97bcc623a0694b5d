// The objects' own levels. Those that share states keep states of their own beside them, which tell as much.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr std::size_t kMaxObjectsPerLook = 64, kMaxModesPerLook = 2048;

}  // namespace

// Some objects after the last ones, at the end of a chunk.
void Mixer::measure_objects() RINGDOWN_REALTIME {
  std::size_t modes = 0;
  const std::size_t most = std::min(kMaxObjectsPerLook, numbers_);
  for (std::size_t n = 0; n < most && modes < kMaxModesPerLook; ++n) {
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

// Some watched objects after the last ones, at the end of a chunk; each at most every ModeWatch::kEvery_s.
void Mixer::measure_modes() RINGDOWN_REALTIME {
  if (next_watched_ == 0) {
    if (now_ - watch_round_ < static_cast<Frame>(ModeWatch::kEvery_s * sample_rate_hz())) return;
    watch_round_ = now_;
  }
  for (std::size_t modes = 0; next_watched_ < kMaxWatched && modes < kMaxModesPerLook; ++next_watched_) {
    ModeWatch::Place& place = mode_watch_.place(next_watched_);
    const std::int64_t object = place.object.load(std::memory_order_acquire);
    if (object < 0) continue;
    place.begin();
    place.of.store(object, std::memory_order_relaxed);
    modes += tell_modes(objects_.data()[object], place);
    place.end();
  }
  if (next_watched_ == kMaxWatched) next_watched_ = 0;
}

// How many modes these are.
std::size_t Mixer::tell_modes(const Object& object, ModeWatch::Place& place) const RINGDOWN_REALTIME {
  place.bank.store(object.current ? &object.current->table().bank() : nullptr, std::memory_order_relaxed);
  if (!object.current) return 0;
  const Voice& voice = *object.current;
  const std::size_t modes = voice.table().bank().mode_count();
  for (std::size_t m = 0; m < modes; ++m) place.amplitudes.get()[m].store(0, std::memory_order_relaxed);
  const double gain = std::abs(object.gain.at(now_));
  if (!object.shared) {
    voice.add_amplitudes(gain, place);
    return modes;
  }
  const Family& family = *voice.table().family;
  if (family.active && object.lost == family.lost) voice.add_amplitudes_at_rest(gain, now_ - object.anchor, place);
  return modes;
}

float Mixer::take_reach(ObjectNumber object) {
  Reach& reach = reaches_[object];
  const float now = reach.now.load(std::memory_order_relaxed);
  return std::max(now, reach.since.exchange(0, std::memory_order_relaxed));
}

}  // namespace ringdown::synth
