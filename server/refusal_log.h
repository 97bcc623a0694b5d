// Logs refusals of messages so that a flood of bad ones does not flood the log: a sentence at most once a second, and
// at most kMaxPerSecond different ones. What was left out is counted, and the counts are logged when the second is
// over.
//
//   refusals.add("127.0.0.1:9000", sentence);   // [any but audio]
//   refusals.report();                          // several times a second, so that counts come though the flood has
//   ended
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace ringdown::server {

class RefusalLog {
 public:
  using Clock = std::chrono::steady_clock;
  using Write = std::function<void(const std::string& line)>;

  static constexpr std::size_t kMaxPerSecond = 20;

  // Writes warnings to the daemon's log.
  RefusalLog();
  // Writes lines by `write`, and asks `now` for the time.
  RefusalLog(Write write, std::function<Clock::time_point()> now);

  // Logs "FROM: SENTENCE", or counts it.
  void add(const std::string& from, const std::string& sentence);

  // Logs the counts of a second that is over.
  void report();

 private:
  void end_second(Clock::time_point now);

  const Write write_;
  const std::function<Clock::time_point()> now_;
  std::mutex mutex_;  // guards the members below
  Clock::time_point begin_{};
  std::map<std::string, std::size_t> repeats_;  // repetitions of the sentences logged in this second
  std::size_t others_ = 0;                      // refusals with other sentences in this second
};

}  // namespace ringdown::server
