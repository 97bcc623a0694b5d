#include "clients/cli/bake/job_board.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sys/ioctl.h>
#include <unistd.h>

namespace ringdown::cli {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(200);

std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 10 ? size.ws_col : 80;
}

int per_cent(double fraction) { return static_cast<int>(std::lround(100 * std::clamp(fraction, 0.0, 1.0))); }

}  // namespace

void JobBoard::begin(const std::string& name) {
  const std::lock_guard lock(mutex_);
  running_[name] = {Clock::now(), "begins", 0};
  draw(true);
}

void JobBoard::stage(const std::string& name, const std::string& stage, double fraction) {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(name);
  if (found == running_.end()) return;
  Running& job = found->second;
  if (style_ == Style::lines && job.stage != stage) std::fprintf(stderr, "%s: %s\n", name.c_str(), stage.c_str());
  job.stage = stage;
  job.fraction = fraction;
  draw(false);
}

void JobBoard::tick() {
  const std::lock_guard lock(mutex_);
  draw(false);
}

void JobBoard::end(const std::string& name, const std::string& line) {
  const std::lock_guard lock(mutex_);
  running_.erase(name);
  ++ended_;
  erase();
  if (style_ != Style::none) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }
  draw(true);
}

void JobBoard::clear() {
  const std::lock_guard lock(mutex_);
  erase();
}

void JobBoard::draw(bool now) {
  const Clock::time_point time = Clock::now();
  if (style_ != Style::live || (!now && time - drawn_at_ < kRedraw)) return;
  erase();
  drawn_at_ = time;
  if (running_.empty()) return;
  const std::size_t width = terminal_width() - 1;  // a line that wraps could not be erased
  std::string text;
  const auto add = [&](const std::string& line) {
    text += line.substr(0, width) + "\n";
    ++drawn_;
  };
  for (const auto& [name, job] : running_) {
    const double seconds = std::chrono::duration<double>(time - job.since).count();
    const std::string share = job.fraction > 0 ? formatted(" {} %", per_cent(job.fraction)) : "";
    add(formatted("{}: {}{}, {} s", name, job.stage, share, std::lround(seconds)));
  }
  add(formatted("{} of {} done", ended_, total_));
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

void JobBoard::erase() {
  if (drawn_ == 0) return;
  std::fprintf(stderr, "\x1b[%dA\r\x1b[J", drawn_);
  std::fflush(stderr);
  drawn_ = 0;
}

}  // namespace ringdown::cli
