#include "clients/cli/bake/progress_line.h"

#include <cmath>
#include <cstdio>

namespace ringdown::cli {

void ProgressLine::show(std::string_view stage, double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (style_ == Style::none || (stage == stage_ && now - shown_ < std::chrono::milliseconds(100))) return;
  stage_ = stage;
  shown_ = now;
  if (style_ == Style::lines) {
    std::printf("%.3f %s\n", fraction, stage_.c_str());
    std::fflush(stdout);
    return;
  }
  constexpr int kWidth = 30;
  std::string bar;
  if (fraction > 0) {
    const int filled = static_cast<int>(std::lround(kWidth * std::min(1.0, fraction)));
    bar = " [" + std::string(filled, '=') + std::string(kWidth - filled, ' ') + "]";
  }
  std::fprintf(stderr, "\r\x1b[K%s: %s%s", title_.c_str(), stage_.c_str(), bar.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (style_ != Style::bar || stage_.empty()) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  stage_.clear();
}

}  // namespace ringdown::cli
