// Threads that help the audio thread with a list of items, without a lock or a system call on the audio thread.
//
// Each thread has its share of the list, the same items in each round, so that their data stay in its cache. A thread
// that has finished takes a few items at a time from the others' shares. A helper that is late, or that the system does
// not run, takes none, and the audio thread does its items; the audio thread waits only for items already taken.
// Helpers spin while there has been work in recent blocks, and sleep otherwise.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace ringdown::synth {

class WorkerPool {
 public:
  static constexpr std::size_t kMaxItems = 1 << 16;

  // `work(item, who)` does an item; `who` is 0 on the audio thread and 1 ... helpers on the others. `work` is called
  // until the pool is destroyed, and must not allocate, lock or throw. [worker]
  WorkerPool(std::size_t helpers, std::function<void(std::size_t item, std::size_t who)> work);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // Does items 0 ... count - 1, count <= kMaxItems, on all threads and returns when all are done. [audio]
  void run(std::size_t count) REALTIME;

 private:
  // Round, end of the share and next item in one word: an item is taken from the round it belongs to or not at all.
  static constexpr unsigned kItemBits = 20;
  static constexpr std::uint64_t kItemMask = (std::uint64_t{1} << kItemBits) - 1;

  struct alignas(64) Share {
    std::atomic<std::uint64_t> next{0};
  };

  void help(std::size_t who, const std::stop_token& stop);
  [[nodiscard]] bool take_some(std::size_t who) REALTIME;
  [[nodiscard]] bool take_some_of(Share& share, std::size_t who) REALTIME;

  std::function<void(std::size_t, std::size_t)> work_;
  std::vector<Share> shares_;  // the audio thread's share, then those of the helpers
  std::uint64_t round_ = 0;    // used by the audio thread only
  alignas(64) std::atomic<std::size_t> done_{0};
  std::vector<std::jthread> helpers_;
};

}  // namespace ringdown::synth
