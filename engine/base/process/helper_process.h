// A program that answers requests one after the other and may do anything while it does: crash, hang, fill the memory,
// talk nonsense. [worker]
//
//   HelperProcess helper;
//   if (auto started = helper.start({program, path}, limits); !started) return fail(started.error());
//   const HelperAnswer answer = helper.ask(request, keep_going);
//   if (answer.end != HelperEnd::answered) ...
//
// Requests and answers are bytes, each after its length, over one socket that is the program's standard input and
// output. Before an answer the program may report its progress. The program's standard error
// is thrown away: what it prints may be somebody else's text.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace ringdown {

struct HelperLimits {
  double processor_s = 600;                                        // for each request
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;             // of its own, not of libraries (RLIMIT_DATA)
  std::uint64_t answer_bytes = std::uint64_t{2} << 30;             // of one answer
  [[nodiscard]] double wall_s() const { return 3 * processor_s; }  // for each request, on a busy machine
};

enum class HelperEnd {
  answered,
  stopped,        // keep_going returned false
  out_of_time,    // processor time or wall time
  out_of_memory,  // it said so, or was near its limit when it crashed
  too_long,       // the answer
  crashed,        // by a signal
  silent,         // it ended, or sent what is no answer
};

struct HelperAnswer {
  HelperEnd end = HelperEnd::silent;
  std::string bytes;
  int signal = 0;  // that ended it
};

class HelperProcess {
 public:
  HelperProcess() = default;
  ~HelperProcess() { stop(); }
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  // Runs `command`, whose first word is a path, with the environment's variables and `added` ones ("NAME=value"). It
  // gets SIGKILL when the thread that started it ends, and ignores SIGINT, SIGTERM and SIGHUP, which a terminal sends
  // to both processes.
  Result<void> start(std::vector<std::string> command, const std::vector<std::string>& added,
                     const HelperLimits& limits);

  [[nodiscard]] bool running() const { return id_ > 0; }

  // The processor time of the program that runs, since it was started; 0 when none does.
  [[nodiscard]] double processor_s() const;

  // `progress` is called with each report, and every 50 ms with the last one. After any end but `answered` the program
  // has ended, and start() may start another.
  HelperAnswer ask(std::string_view request, const Progress& progress);

  // Ends the program, if it runs, and waits for its end.
  void stop();

 private:
  HelperAnswer ended(HelperEnd end);
  HelperAnswer ended_by_itself();

  pid_t id_ = 0;
  int pipe_ = -1;  // a socket, for both directions
  HelperLimits limits_;
};

// The program's side. [main]

inline constexpr int kHelperOutOfMemory = 71;  // the exit code by which a helper says that it had too little memory

class HelperPipe {
 public:
  // Takes the standard input and output, which lead nowhere from then on.
  HelperPipe();

  // The next request; false when there is none any more.
  bool next(std::string& request) const;
  void report(std::string_view stage, double fraction) const;
  void answer(std::string_view bytes) const;

 private:
  int pipe_ = -1;
};

}  // namespace ringdown
