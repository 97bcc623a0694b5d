// What a process holds, from /proc: memory and open descriptors, and how memory grows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <sys/types.h>
#include <vector>

namespace ringdown::test {

double resident_mb(pid_t process);       // private memory in use (RssAnon)
std::size_t descriptors(pid_t process);  // open ones

// Bytes that a program of ours holds from malloc, counted by heap_meter.cpp, which is preloaded into it.
class HeapMeter {
 public:
  // A file for the count; `preload` is the library made of heap_meter.cpp.
  HeapMeter(const std::filesystem::path& file, std::string preload);
  ~HeapMeter();
  HeapMeter(const HeapMeter&) = delete;
  HeapMeter& operator=(const HeapMeter&) = delete;

  [[nodiscard]] std::map<std::string, std::string> environment() const;  // for the program
  [[nodiscard]] double kilobytes() const;

 private:
  std::filesystem::path file_;
  std::string preload_;
  const std::int64_t* count_ = nullptr;
};

// The slope of a line by least squares through what was noted, the first quarter, where a program is still getting
// going, left out.
class Growth {
 public:
  void note(double time_s, double kilobytes) { points_.push_back({time_s, kilobytes}); }
  [[nodiscard]] double mb_per_hour() const;

 private:
  struct Point {
    double time_s, kilobytes;
  };
  std::vector<Point> points_;
};

}  // namespace ringdown::test
