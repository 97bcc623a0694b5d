// Counts how many modes ring at which level. Shedding reads its threshold from the histogram. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/muting.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class LevelHistogram {
 public:
  static constexpr Level kMinLevel = -440, kLevels = 560;  // -165 ... +45 dB; what lies outside counts at the ends

  void clear() REALTIME {
    groups_.fill(0);
    total_ = 0;
  }

  // Counts one group of kModePadding modes.
  void add(Level level) REALTIME {
    ++groups_[static_cast<std::size_t>(std::clamp<Level>(level - kMinLevel, 0, kLevels - 1))];
    ++total_;
  }

  [[nodiscard]] std::size_t modes() const REALTIME { return kModePadding * total_; }
  [[nodiscard]] std::size_t modes_from(Level level) const REALTIME {
    std::size_t groups = 0;
    for (Level i = std::clamp<Level>(level - kMinLevel, 0, kLevels); i < kLevels; ++i) {
      groups += groups_[static_cast<std::size_t>(i)];
    }
    return kModePadding * groups;
  }

  // The lowest level such that at most `modes` modes lie at or above it; `none` when there are no more modes than that.
  [[nodiscard]] Level threshold_for(double modes, Level none) const REALTIME {
    if (static_cast<double>(this->modes()) <= modes) return none;
    Level threshold = kMinLevel + kLevels;
    for (double left = modes; threshold > kMinLevel; --threshold) {
      left -= static_cast<double>(kModePadding * groups_[static_cast<std::size_t>(threshold - 1 - kMinLevel)]);
      if (left < 0) break;
    }
    return threshold;
  }

 private:
  std::array<std::uint32_t, kLevels> groups_{};
  std::size_t total_ = 0;
};

}  // namespace ringdown::synth
