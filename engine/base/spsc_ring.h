// A bounded queue between exactly one producing and one consuming thread, without locks.
//
// Only the producer writes the write index, only the consumer the read index. Both count up without wrapping, so the
// queue is full if `write - read == capacity`, and no slot is wasted. push() releases the slot that it has filled,
// front() acquires it. No function allocates, blocks or makes a system call.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <bit>
#include <cassert>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace ringdown {

template <class T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>, "the audio thread copies elements and must not run destructors");

 public:
  // `capacity` is rounded up to a power of two. [any thread, before use]
  explicit SpscRing(std::size_t capacity) : slots_(std::bit_ceil(capacity)) { assert(capacity > 0); }

  // Returns false if the queue is full; the element is then not taken, and the caller counts or reports it. [producer]
  [[nodiscard]] bool push(const T& element) REALTIME {
    const std::size_t write = write_.load(std::memory_order_relaxed);
    if (write - read_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[write & (slots_.size() - 1)] = element;
    write_.store(write + 1, std::memory_order_release);
    return true;
  }

  // Returns the oldest element, or nullptr if the queue is empty. The element stays valid until pop(). [consumer]
  [[nodiscard]] const T* front() const REALTIME {
    const std::size_t read = read_.load(std::memory_order_relaxed);
    if (read == write_.load(std::memory_order_acquire)) return nullptr;
    return slots_.data() + (read & (slots_.size() - 1));
  }

  // Removes the element that front() returned. [consumer]
  void pop() REALTIME { read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  // The number of waiting elements. The other thread may change it meanwhile: for the consumer the result is a lower
  // bound, for the producer an upper bound. [producer, consumer]
  [[nodiscard]] std::size_t size() const REALTIME {
    const std::size_t read = read_.load(std::memory_order_acquire);
    return write_.load(std::memory_order_acquire) - read;
  }

  [[nodiscard]] std::size_t capacity() const REALTIME { return slots_.size(); }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> write_ = 0;
  alignas(64) std::atomic<std::size_t> read_ = 0;
};

}  // namespace ringdown
