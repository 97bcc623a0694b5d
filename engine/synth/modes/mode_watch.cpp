#include "engine/synth/modes/mode_watch.h"

#include "engine/modal/bank_file.h"

#include <algorithm>

namespace ringdown::synth {

bool ModeWatch::watch(ObjectNumber object) {
  if (find(object)) return true;
  const auto free = std::ranges::find_if(slots_, [](const Slot& slot) { return slot.object.load() < 0; });
  if (free == slots_.end()) return false;
  if (!free->amplitudes) free->amplitudes = std::make_unique<std::atomic<float>[]>(modal::kMaxModes);
  free->object.store(object, std::memory_order_release);
  ++count_;
  return true;
}

void ModeWatch::unwatch(ObjectNumber object) {
  for (Slot& slot : slots_) {
    if (slot.object.load() != object) continue;
    slot.object = -1;
    --count_;
  }
}

const ModeWatch::Slot* ModeWatch::find(ObjectNumber object) const {
  const auto found = std::ranges::find_if(slots_, [object](const Slot& slot) { return slot.object == object; });
  return found == slots_.end() ? nullptr : &*found;
}

// A sequence lock. The audio thread makes the slot's number odd while it writes and even again when it is done, and
// never waits. The reader copies the amplitudes and keeps them only if the number was even before and is the same
// afterwards; otherwise it tries again. The fences are those of Boehm, Can Seqlocks Get Along with Programming Language
// Memory Models?, MSPC 2012.
bool ModeWatch::read(ObjectNumber object, const modal::Bank& bank, std::vector<float>& amplitudes) const {
  constexpr int kTries = 100;
  const Slot* const slot = find(object);
  if (!slot) return false;
  amplitudes.resize(bank.mode_count());
  for (int i = 0; i < kTries; ++i) {
    const std::uint32_t before = slot->number.load(std::memory_order_acquire);
    if (before % 2 != 0) continue;
    const bool same =
        slot->of.load(std::memory_order_relaxed) == object && slot->bank.load(std::memory_order_relaxed) == &bank;
    for (std::size_t m = 0; same && m < amplitudes.size(); ++m) {
      amplitudes[m] = slot->amplitudes[m].load(std::memory_order_relaxed);
    }
    std::atomic_thread_fence(std::memory_order_acquire);
    if (slot->number.load(std::memory_order_relaxed) == before) return same;
  }
  return false;
}

void ModeWatch::Slot::begin() REALTIME {
  number.store(number.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
}

void ModeWatch::Slot::end() REALTIME {
  number.store(number.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace ringdown::synth
