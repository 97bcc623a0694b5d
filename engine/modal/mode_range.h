// A range of a bank's modes, numbered from 0, the lowest, by ascending frequency, as people count them. The bank itself
// orders its modes by importance.
#pragma once

#include <cstdint>
#include <limits>

namespace ringdown::modal {

struct ModeRange {
  static constexpr std::uint32_t kAll = std::numeric_limits<std::int32_t>::max();

  std::uint32_t first = 0;
  std::uint32_t count = kAll;  // a larger number than the bank has means all of its modes

  [[nodiscard]] bool has(std::size_t rank) const { return rank >= first && rank - first < count; }
  friend bool operator==(const ModeRange&, const ModeRange&) = default;
};

}  // namespace ringdown::modal
