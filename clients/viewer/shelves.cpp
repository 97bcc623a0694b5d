#include "clients/viewer/shelves.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr float kGapShare = 0.3F, kMinGap_m = 0.02F;  // of the thing's width or depth
constexpr float kWide = 2;                            // width over depth of the whole, about

glm::vec2 with_gap(glm::vec2 extent) {
  return {extent.x + kGapShare * extent.x + kMinGap_m, extent.y + kGapShare * extent.y + kMinGap_m};
}

}  // namespace

std::vector<glm::vec2> on_shelves(std::span<const glm::vec2> extents_m) {
  float area = 0, row_width = 0;
  for (const glm::vec2 extent : extents_m) {
    const glm::vec2 place = with_gap(extent);
    area += place.x * place.y;
    row_width = std::max(row_width, place.x);
  }
  row_width = std::max(row_width, std::sqrt(kWide * area));
  std::vector<glm::vec2> corners;
  glm::vec2 at{0, 0};
  float depth = 0;  // of the present row
  for (const glm::vec2 extent : extents_m) {
    const glm::vec2 place = with_gap(extent);
    if (at.x > 0 && at.x + extent.x > row_width) {
      at = {0, at.y + depth};
      depth = 0;
    }
    corners.push_back(at);
    at.x += place.x;
    depth = std::max(depth, place.y);
  }
  return corners;
}

}  // namespace ringdown::viewer
