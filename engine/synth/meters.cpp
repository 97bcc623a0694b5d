#include "engine/synth/meters.h"

#include "engine/synth/stage.h"

#include <algorithm>

namespace ringdown::synth {
namespace {

constexpr std::size_t kMaxObjectsPerChunk = 64, kMaxModesPerChunk = 2048;

}  // namespace

void Meters::measure(const Stage& stage, Frame now, double sample_rate_hz) REALTIME {
  if (watches_objects_.load(std::memory_order_relaxed)) measure_objects(stage, now);
  if (mode_watch.watches()) measure_modes(stage, now, sample_rate_hz);
}

// Measures some objects after those of the last chunk.
void Meters::measure_objects(const Stage& stage, Frame now) REALTIME {
  std::size_t modes = 0;
  const std::size_t max = std::min(kMaxObjectsPerChunk, stage.object_limit());
  for (std::size_t n = 0; n < max && modes < kMaxModesPerChunk; ++n) {
    if (next_object_ >= stage.object_limit()) next_object_ = 0;
    PeakLevel& level = peak_levels_[next_object_];
    const Object* const object = stage.object(next_object_++);
    const auto measured = object ? static_cast<float>(object->peak_level(now, modes)) : 0.0f;
    level.now.store(measured, std::memory_order_relaxed);
    if (measured > level.since.load(std::memory_order_relaxed)) {
      level.since.store(measured, std::memory_order_relaxed);
    }
  }
}

// Writes some slots after those of the last chunk, each at most every ModeWatch::kEvery_s.
void Meters::measure_modes(const Stage& stage, Frame now, double sample_rate_hz) REALTIME {
  if (next_slot_ == 0) {
    if (now - slots_began_ < static_cast<Frame>(ModeWatch::kEvery_s * sample_rate_hz)) return;
    slots_began_ = now;
  }
  for (std::size_t modes = 0; next_slot_ < kMaxWatched && modes < kMaxModesPerChunk; ++next_slot_) {
    ModeWatch::Slot& slot = mode_watch.slot(next_slot_);
    const std::int64_t object = slot.object.load(std::memory_order_acquire);
    if (object < 0) continue;
    slot.begin();
    slot.of.store(object, std::memory_order_relaxed);
    const Object* const watched = stage.object(static_cast<std::size_t>(object));
    if (watched) modes += watched->write_amplitudes(now, slot);
    slot.end();
  }
  if (next_slot_ == kMaxWatched) next_slot_ = 0;
}

float Meters::take_peak_level(ObjectNumber object) {
  PeakLevel& level = peak_levels_[object];
  const float now = level.now.load(std::memory_order_relaxed);
  return std::max(now, level.since.exchange(0, std::memory_order_relaxed));
}

void Meters::note_peak(float peak) REALTIME {
  counters.peak.store(peak, std::memory_order_relaxed);
  if (peak > counters.peak_since.load(std::memory_order_relaxed)) {
    counters.peak_since.store(peak, std::memory_order_relaxed);
  }
}

}  // namespace ringdown::synth
