#include "clients/viewer/pace.h"

#include <algorithm>

namespace ringdown::viewer {

void Pace::observe(double frame_s) {
  constexpr double kStep = 0.75;
  sum_s_ += frame_s;
  if (++frames_ < kFrames) return;
  const double mean_s = sum_s_ / kFrames;
  sum_s_ = 0;
  frames_ = 0;
  if (mean_s > kSlow_s) detail_ = std::max(kCoarsest, kStep * detail_);
  if (mean_s < kQuick_s) detail_ = std::min(1.0, detail_ / kStep);
}

}  // namespace ringdown::viewer
