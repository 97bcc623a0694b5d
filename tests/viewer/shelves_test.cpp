#include "clients/viewer/shelves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace ringdown::viewer {
namespace {

TEST(Shelves, NothingStandsInAnotherThing) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> extent(0.01F, 1);
  for (const std::size_t count : {1u, 2u, 7u, 37u}) {
    std::vector<glm::vec2> extents;
    for (std::size_t i = 0; i < count; ++i) extents.emplace_back(extent(random), extent(random));
    const auto corners = on_shelves(extents);
    ASSERT_EQ(corners.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_GE(corners[i].x, 0);
      EXPECT_GE(corners[i].y, 0);
      for (std::size_t j = 0; j < i; ++j) {
        const bool beside = corners[i].x >= corners[j].x + extents[j].x || corners[j].x >= corners[i].x + extents[i].x;
        const bool behind = corners[i].y >= corners[j].y + extents[j].y || corners[j].y >= corners[i].y + extents[i].y;
        EXPECT_TRUE(beside || behind) << i << " and " << j << " of " << count;
      }
    }
  }
}

TEST(Shelves, ManyMakeRowsInsteadOfALine) {
  const std::vector<glm::vec2> extents(32, {0.1F, 0.1F});
  const auto corners = on_shelves(extents);
  const float width = std::ranges::max(corners, {}, &glm::vec2::x).x,
              depth = std::ranges::max(corners, {}, &glm::vec2::y).y;
  EXPECT_GT(width, depth);
  EXPECT_LT(width, 4 * depth);
  EXPECT_TRUE(on_shelves({}).empty());
}

}  // namespace
}  // namespace ringdown::viewer
