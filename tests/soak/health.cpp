#include "tests/soak/health.h"

#include <fcntl.h>
#include <fstream>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>

namespace ringdown::test {

double resident_mb(pid_t process) {
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

HeapMeter::HeapMeter(const std::filesystem::path& file, std::string preload)
    : file_(file), preload_(std::move(preload)) {
  const int descriptor = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (::ftruncate(descriptor, sizeof(std::int64_t)) == 0) {
    void* const page = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, descriptor, 0);
    if (page != MAP_FAILED) count_ = static_cast<const std::int64_t*>(page);
  }
  ::close(descriptor);
}

HeapMeter::~HeapMeter() {
  if (count_) ::munmap(const_cast<std::int64_t*>(count_), sizeof(std::int64_t));
}

std::map<std::string, std::string> HeapMeter::environment() const {
  return {{"LD_PRELOAD", preload_}, {"RINGDOWN_HEAP_METER", file_.string()}};
}

double HeapMeter::kilobytes() const {
  return count_ ? static_cast<double>(*static_cast<const volatile std::int64_t*>(count_)) / 1024 : 0;
}

double Growth::mb_per_hour() const {
  double n = 0, t = 0, k = 0, tt = 0, tk = 0;
  for (std::size_t i = points_.size() / 4; i < points_.size(); ++i) {
    const auto [time_s, kilobytes] = points_[i];
    n += 1, t += time_s, k += kilobytes, tt += time_s * time_s, tk += time_s * kilobytes;
  }
  const double spread = n * tt - t * t;
  return spread > 0 ? (n * tk - t * k) / spread * 3600 / 1024 : 0;
}

}  // namespace ringdown::test
