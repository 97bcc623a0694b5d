#include "tests/soak/health.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace ringdown::test {

double memory_mb(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssAnon:")) return std::stod(line.substr(8)) / 1024;
  }
  return 0;
}

std::size_t descriptors(pid_t process) {
  std::error_code error;
  const std::filesystem::directory_iterator all("/proc/" + std::to_string(process) + "/fd", error), end;
  return static_cast<std::size_t>(std::distance(all, end));
}

double Growth::mb_per_hour() const {
  const auto middle = [this](double from, double to) {
    const auto at = [this](double share) {
      return static_cast<std::size_t>(share * static_cast<double>(points_.size()));
    };
    std::vector<Point> part(points_.begin() + static_cast<std::ptrdiff_t>(at(from)),
                            points_.begin() + static_cast<std::ptrdiff_t>(at(to)));
    const double time_s = (part.front().time_s + part.back().time_s) / 2;
    std::sort(part.begin(), part.end(), [](const Point& a, const Point& b) { return a.memory_mb < b.memory_mb; });
    return Point{time_s, part[part.size() / 2].memory_mb};
  };
  if (points_.size() < 16) return 0;
  const Point early = middle(0.25, 0.5), late = middle(0.75, 1);
  return (late.memory_mb - early.memory_mb) / (late.time_s - early.time_s) * 3600;
}

}  // namespace ringdown::test
