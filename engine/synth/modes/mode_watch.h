// The amplitudes of the modes of some objects, from the audio thread to one that shows them, without a lock.
//
// Each watched object has a slot, which the audio thread writes about every kEvery_s and the reader reads whenever it
// likes; a number before and after tells the reader whether it was written meanwhile.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/bank.h"
#include "engine/synth/events/event.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ringdown::synth {

inline constexpr std::size_t kMaxWatched = 16;  // objects

class ModeWatch {
 public:
  static constexpr double kEvery_s = 0.01;

  // Watches the object from now on. False when kMaxWatched others are. Watching it twice is watching it once.
  // [one thread at a time that is not audio]
  [[nodiscard]] bool watch(ObjectNumber object);
  void unwatch(ObjectNumber object);

  // Reads the amplitude of each mode of `bank`, in its order. False when the object is not watched, has another bank,
  // or nothing was written of it yet. [one thread that is not audio]
  [[nodiscard]] bool read(ObjectNumber object, const modal::Bank& bank, std::vector<float>& amplitudes) const;

  // For the mixer. A slot lies between begin() and end() while it is written.
  struct Slot {
    std::atomic<std::int64_t> object{-1};  // none
    std::atomic<std::uint32_t> number{0};  // odd while it is written
    std::atomic<std::int64_t> of{-1};      // whose amplitudes these are
    std::atomic<const modal::Bank*> bank{nullptr};
    std::unique_ptr<std::atomic<float>[]> amplitudes;  // one per mode of any bank; there when the object first is

    void begin() REALTIME;
    void end() REALTIME;
    void add(std::size_t mode, double amplitude) REALTIME {
      std::atomic<float>& sum = amplitudes.get()[mode];
      sum.store(sum.load(std::memory_order_relaxed) + static_cast<float>(amplitude), std::memory_order_relaxed);
    }
  };
  [[nodiscard]] bool watches() const REALTIME { return count_.load(std::memory_order_relaxed) > 0; }
  [[nodiscard]] Slot& slot(std::size_t which) REALTIME { return slots_[which]; }

 private:
  [[nodiscard]] const Slot* find(ObjectNumber object) const;

  std::array<Slot, kMaxWatched> slots_;
  std::atomic<std::size_t> count_{0};
};

}  // namespace ringdown::synth
