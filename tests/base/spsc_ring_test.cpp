#include "engine/base/spsc_ring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace ringdown {
namespace {

TEST(SpscRing, ARingReturnsElementsInOrder) {
  SpscRing<int> ring(4);
  for (const int value : {7, 8, 9}) ASSERT_TRUE(ring.push(value));
  for (const int value : {7, 8, 9}) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), value);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(SpscRing, ARingHoldsItsCapacityAndRefusesOneMore) {
  SpscRing<int> ring(5);
  EXPECT_EQ(ring.capacity(), 8u);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(ring.push(i)) << i;
  EXPECT_FALSE(ring.push(8));
  EXPECT_EQ(*ring.front(), 0);
  ring.pop();
  EXPECT_TRUE(ring.push(8));
  EXPECT_FALSE(ring.push(9));
}

TEST(SpscRing, ARingOfCapacityOneAlternatesBetweenFullAndEmpty) {
  SpscRing<int> ring(1);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(ring.push(i));
    ASSERT_FALSE(ring.push(-1));
    ASSERT_EQ(*ring.front(), i);
    ring.pop();
  }
}

// Each element holds its number twice: a torn or reordered one would show.
TEST(SpscRing, ARingPassesAMillionElementsBetweenTwoThreads) {
  struct Pair {
    std::uint64_t number, complement;
  };
  constexpr std::uint64_t kCount = 1'000'000;
  SpscRing<Pair> ring(256);
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kCount; ++i) {
      while (!ring.push({i, ~i})) std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const Pair* pair = ring.front();
    for (; !pair; pair = ring.front()) std::this_thread::yield();
    wrong += pair->number != i || pair->complement != ~i;
    ring.pop();
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(ring.front(), nullptr);
}

}  // namespace
}  // namespace ringdown
