// What is being done, said on the way. [one thread]
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace ringdown::cli {

class ProgressLine {
 public:
  enum class Style {
    none,
    bar,   // one line on stderr that begins with the title, rewritten in place
    lines  // for programs: lines "0.425 STAGE" on stdout, the fraction as in show()
  };
  ProgressLine(std::string title, Style style) : title_(std::move(title)), style_(style) {}
  ProgressLine(std::string title, bool shown) : ProgressLine(std::move(title), shown ? Style::bar : Style::none) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // At most ten times a second, or when the stage changes. fraction in 0..1; 0 where it is not known.
  void show(std::string_view stage, double fraction);
  void clear();

 private:
  std::string title_;
  Style style_;
  std::string stage_;
  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace ringdown::cli
