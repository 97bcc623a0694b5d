// The daemon's log: lines on the standard error that never wait for a reader.
//
//   Log log(STDERR_FILENO);              // where lines go from now on  [main, before other threads start]
//   log_warning("...");                  // [any but audio]
//   log.report_dropped();                // now and then  [main]
//   return log.complain(error);          // the last words before an exit  [main]
//
// A pipe whose reader has stopped takes 64 KiB; then a plain write() would wait for ever, and the logging thread with
// it: OSC would no longer be answered, and no signal would end the daemon. So lines without room are dropped and
// counted, and the count is logged as soon as there is room again.
#pragma once

#include "engine/base/result.h"
#include "protocol/exit_codes.h"

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

namespace ringdown::server {

// Writes lines to a pipe, a terminal, a socket or a file without ever waiting. [any but audio]
class LineWriter {
 public:
  // `descriptor` stays open as long as the writer lives.
  explicit LineWriter(int descriptor);
  ~LineWriter();
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  // Writes a line that ends in '\n', or drops it. Waits for room no longer than `patience`.
  void write(std::string_view line, std::chrono::milliseconds patience = {});

  // Writes the number of lines dropped since the last such report, if there are any and there is room.
  void report_dropped();

 private:
  void report(std::chrono::milliseconds patience);
  // Writes `text` as far as there is room, and keeps the rest of a line that has begun. Returns false if nothing was
  // written.
  bool put(std::string_view text, std::chrono::milliseconds patience);
  std::size_t write_some(std::string_view text);

  enum class Kind { nonblocking, socket, other };

  int descriptor_;
  bool owns_ = false;
  Kind kind_ = Kind::other;
  std::mutex mutex_;         // guards the members below
  std::string rest_;         // rest of a partly written line
  std::size_t dropped_ = 0;  // lines since the last report
};

// Both log a line: "12:34:56.789 info ready". Without a Log, lines are discarded. [any but audio]
void log_info(std::string_view sentence);
void log_warning(std::string_view sentence);

// Returns a number with this many decimals, for log sentences.
std::string fixed(double value, int decimals);

// A Log receives the log lines of the whole process as long as it lives.
class Log {
 public:
  // Writes to `descriptor`, in colours if it is a terminal.
  explicit Log(int descriptor);
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void report_dropped() { writer_.report_dropped(); }

  // Like protocol::complain(), but waits for room no longer than a second.
  protocol::ExitCode complain(const Error& error);

 private:
  friend void log_info(std::string_view sentence);
  friend void log_warning(std::string_view sentence);
  void write(const char* level, const char* color, std::string_view sentence);

  LineWriter writer_;
  bool colored_;
};

}  // namespace ringdown::server
