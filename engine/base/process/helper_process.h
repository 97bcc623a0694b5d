// Runs a helper program that answers requests one after another, and survives all its failures: the helper may crash,
// hang, fill the memory or send nonsense. [worker]
//
//   HelperProcess helper;
//   if (auto started = helper.start({program, path}, limits); !started) return fail(started);
//   const HelperAnswer answer = helper.ask(request, keep_going);
//   if (answer.end != HelperEnd::answered) ...
//
// Requests and answers are bytes, each after its length, over one socket that is the program's standard input and
// output. Before an answer the program may report its progress. The program's standard error is discarded, because it
// may contain text from untrusted files.
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
  double processor_s = 600;                                        // processor time for each request
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;             // the program's data without libraries (RLIMIT_DATA)
  std::uint64_t answer_bytes = std::uint64_t{2} << 30;             // length of one answer
  [[nodiscard]] double wall_s() const { return 3 * processor_s; }  // wall time for each request, on a busy machine
};

enum class HelperEnd {
  answered,
  stopped,        // keep_going returned false
  out_of_time,    // processor time or wall time
  out_of_memory,  // the program said so, or was near its limit when it crashed
  too_long,       // the answer exceeded answer_bytes
  crashed,        // a signal ended the program
  silent,         // the program ended by itself or sent an invalid answer
};

struct HelperAnswer {
  HelperEnd end = HelperEnd::silent;
  std::string bytes;
  int signal = 0;  // the signal that ended the program
};

class HelperProcess {
 public:
  HelperProcess() = default;
  ~HelperProcess() { stop(); }
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  // Runs `command`, whose first word is a path, with the environment's variables and the `added` ones ("NAME=value").
  // The program gets SIGKILL when the thread that started it ends. It ignores SIGINT, SIGTERM and SIGHUP, which a
  // terminal sends to both processes.
  Result<void> start(std::vector<std::string> command, const std::vector<std::string>& added,
                     const HelperLimits& limits);

  [[nodiscard]] bool running() const { return id_ > 0; }

  // The processor time of the running program since its start; 0 if none is running.
  [[nodiscard]] double processor_s() const;

  // Sends a request and waits for the answer. `progress` is called with each report, and every 50 ms with the last one.
  // After any end but `answered` the program has ended, and start() may start another.
  HelperAnswer ask(std::string_view request, const Progress& progress);

  // Ends the program, if it is running, and waits for its end.
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
  // Takes over standard input and output, which are disconnected from then on.
  HelperPipe();

  // Reads the next request; returns false when there are no more.
  bool next(std::string& request) const;
  void report(std::string_view stage, double fraction) const;
  void answer(std::string_view bytes) const;

 private:
  int pipe_ = -1;
};

}  // namespace ringdown
