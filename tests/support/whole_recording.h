// Recordings by the clock in which nothing is missing and nothing else is heard. On a busy machine a recording may lose
// blocks, or get two sounds where one was meant; it is then made again. In freewheel, which waits for every client,
// this does not happen.
//
//   const auto tone = whole_recording([&]() -> std::optional<DampedSinusoid> {
//     ... play, record, fit ...
//     return is_pure ? std::optional(fitted) : std::nullopt;
//   });
//   ASSERT_TRUE(tone);
#pragma once

#include "tests/integration/process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace ringdown::test {

// Calls `take`, which returns nothing for a recording that is not whole, until there is one. Nothing comes back when no
// take was whole for as long as a test is patient, or when the test has failed.
template <class Take>
auto whole_recording(const Take& take) -> decltype(take()) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!testing::Test::HasFailure() && std::chrono::steady_clock::now() < end) {
    if (auto recording = take()) return recording;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {};
}

}  // namespace ringdown::test
