// Shows the progress of several jobs that run at the same time. [any thread]
//
// On a terminal, each running job has one line with its stage, percentage and seconds, rewritten in place below the
// lines of the finished jobs. Elsewhere there is a line for each finished job and, with Style::lines, one for each
// stage that begins.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace ringdown::cli {

class JobBoard {
 public:
  enum class Style { none, done, lines, live };

  // `total` is the number of jobs.
  JobBoard(Style style, std::size_t total) : style_(style), total_(total) {}
  ~JobBoard() { clear(); }
  JobBoard(const JobBoard&) = delete;
  JobBoard& operator=(const JobBoard&) = delete;

  void begin(const std::string& name);
  void stage(const std::string& name, const std::string& stage, double fraction);  // in 0..1, 0 where it is not known
  void tick();                                                 // call it now and then: updates the seconds
  void clear();                                                // erases the lines from the terminal, for other output
  void end(const std::string& name, const std::string& line);  // to stdout

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    Clock::time_point since;
    std::string stage;
    double fraction = 0;
  };
  void draw(bool now);
  void erase();

  const Style style_;
  const std::size_t total_;
  std::mutex mutex_;
  std::map<std::string, Running> running_;
  std::size_t ended_ = 0;
  int drawn_ = 0;  // lines on the terminal
  Clock::time_point drawn_at_{};
};

}  // namespace ringdown::cli
