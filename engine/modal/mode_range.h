// Some of a bank's modes, counted by ascending frequency from 0, the lowest, as people count them; the bank itself
// stands in order of importance.
#pragma once

#include <cstdint>
#include <limits>

namespace ringdown::modal {

struct ModeRange {
  static constexpr std::uint32_t kAll = std::numeric_limits<std::int32_t>::max();

  std::uint32_t first = 0;
  std::uint32_t count = kAll;  // those that there are, at most

  [[nodiscard]] bool has(std::size_t rank) const { return rank >= first && rank - first < count; }
  friend bool operator==(const ModeRange&, const ModeRange&) = default;
};

}  // namespace ringdown::modal
