// Threads that help the audio thread with a list of things to do, without a lock or a system call on its side.
//
// Each thread has its share of the list, the same items in each round, so that what they touch stays in its cache;
// whoever is done takes a few items at a time from the others' shares. A helper that is late, or that the system does
// not let run, takes none, and the audio thread does them; it waits only for items that somebody has taken. Helpers
// spin while there has been work in recent blocks, and sleep otherwise.
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

  // `work(item, who)` does an item; who is 0 on the audio thread and 1 ... helpers on the others. It lives as long as
  // the pool, and allocates, locks and throws nothing. [worker]
  WorkerPool(std::size_t helpers, std::function<void(std::size_t item, std::size_t who)> work);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // Has items 0 ... count - 1 done, count <= kMaxItems, and returns when all are. [audio]
  void run(std::size_t count) RINGDOWN_REALTIME;

 private:
  // Round, end of the share and next item in one word: an item is taken from the round it belongs to or not at all.
  static constexpr unsigned kItemBits = 20;
  static constexpr std::uint64_t kItemMask = (std::uint64_t{1} << kItemBits) - 1;

  struct alignas(64) Share {
    std::atomic<std::uint64_t> next{0};
  };

  void help(std::size_t who, const std::stop_token& stop);
  [[nodiscard]] bool take_some(std::size_t who) RINGDOWN_REALTIME;
  [[nodiscard]] bool take_some_of(Share& share, std::size_t who) RINGDOWN_REALTIME;

  std::function<void(std::size_t, std::size_t)> work_;
  std::vector<Share> shares_;  // of the audio thread, then of the helpers
  std::uint64_t round_ = 0;    // the audio thread's own
  alignas(64) std::atomic<std::size_t> done_{0};
  std::vector<std::jthread> helpers_;
};

}  // namespace ringdown::synth
