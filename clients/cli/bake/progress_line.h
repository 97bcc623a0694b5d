// One line on stderr that says what is being done, rewritten in place. [one thread]
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace ringdown::cli {

class ProgressLine {
 public:
  // Shows nothing unless `enabled`. `title` starts the line.
  ProgressLine(std::string title, bool enabled) : title_(std::move(title)), enabled_(enabled) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // At most ten times a second, or when the stage changes. fraction in 0..1; 0 shows no bar.
  void show(std::string_view stage, double fraction);
  void clear();

 private:
  std::string title_;
  bool enabled_;
  std::string stage_;
  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace ringdown::cli
