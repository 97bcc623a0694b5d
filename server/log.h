// The daemon's log: lines on the standard error that never wait for whoever reads them.
//
//   Log log(STDERR_FILENO);              // where lines go from now on  [main, before other threads start]
//   log_warning("{} is gone", name);     // in fmt's format  [any but audio]
//   log.report_dropped();                // now and then  [main]
//   return log.complain(error);          // the last words before an exit  [main]
//
// A pipe whose reader has stopped takes 64 KiB, then a plain write() would wait for ever, and with it the thread that
// logs: OSC would not be answered any more, and no signal would end the daemon. So lines for which there is no room are
// dropped and counted, and the count is logged as soon as there is room again.
#pragma once

#include "engine/base/result.h"
#include "protocol/exit_codes.h"

#include <fmt/core.h>

#include <chrono>
#include <cstddef>
#include <memory>
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

  // Writes how many lines were dropped since the last such report, if any were and there is room.
  void report_dropped();

 private:
  void report(std::chrono::milliseconds patience);
  // Writes `text` as far as there is room, and keeps what is left of a line that has begun. False: nothing was written.
  bool put(std::string_view text, std::chrono::milliseconds patience);
  std::size_t write_some(std::string_view text);

  enum class Kind { nonblocking, socket, other };

  int descriptor_;
  bool owns_ = false;
  Kind kind_ = Kind::other;
  std::mutex mutex_;         // guards the members below
  std::string rest_;         // of a line that was written in part
  std::size_t dropped_ = 0;  // lines since the last report
};

enum class LogLevel { info, warning };

// Logs a line of `format` and its values. spdlog, which writes it, is compiled in log.cpp alone. [any but audio]
void log_line(LogLevel level, fmt::string_view format, fmt::format_args values);

template <class... Values>
void log_info(fmt::format_string<Values...> format, Values&&... values) {
  log_line(LogLevel::info, format, fmt::make_format_args(values...));
}
template <class... Values>
void log_warning(fmt::format_string<Values...> format, Values&&... values) {
  log_line(LogLevel::warning, format, fmt::make_format_args(values...));
}

class Log {
 public:
  // Writes to `descriptor`, in colours if it is a terminal.
  explicit Log(int descriptor);

  void report_dropped() { writer_->report_dropped(); }

  // As protocol::complain(), but waits for room no longer than a second.
  protocol::ExitCode complain(const Error& error);

 private:
  std::shared_ptr<LineWriter> writer_;
};

}  // namespace ringdown::server
