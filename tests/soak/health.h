// What a process holds, from /proc: memory and open descriptors, and how memory grows.
#pragma once

#include <cstddef>
#include <sys/types.h>
#include <vector>

namespace ringdown::test {

double memory_mb(pid_t process);         // private memory that is in use (RssAnon)
std::size_t descriptors(pid_t process);  // open ones

// The slope of a line through (time, memory) by least squares, its first part, where a program is still getting going,
// left out.
class Growth {
 public:
  void note(double time_s, double memory_mb) { points_.push_back({time_s, memory_mb}); }

  // Between the median of the second quarter and that of the last, so that single excursions do not count.
  [[nodiscard]] double mb_per_hour() const;

 private:
  struct Point {
    double time_s, memory_mb;
  };
  std::vector<Point> points_;
};

}  // namespace ringdown::test
