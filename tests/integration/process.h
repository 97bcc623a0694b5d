// Programs that a test runs: started with their own environment, their output kept, ended by id.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace ringdown::test {

// How long a test waits for what must happen: many times what the busiest machine needs. No test depends on how soon it
// happens.
inline constexpr std::chrono::seconds kPatience{120};

class Process {
 public:
  using Environment = std::map<std::string, std::string>;  // added to ours

  // Starts `command` (searched in PATH); standard output and error go to one file.
  explicit Process(const std::vector<std::string>& command, const Environment& environment = {});
  ~Process();  // SIGTERM, then SIGKILL, if it still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] pid_t id() const { return id_; }
  void send_signal(int signal) const;

  // Its exit code (128 + signal if one ended it), or nothing when it still runs after `limit`.
  std::optional<int> wait(std::chrono::milliseconds limit = kPatience);

  // A line of /proc/PID/status, such as "VmRSS:" or "VmHWM:", the peak; 0 when the process has ended.
  [[nodiscard]] long memory_kb(const std::string& key) const;
  void forget_peak() const;  // VmHWM starts anew

  [[nodiscard]] std::string output() const;
  // Waits until the output holds `text`; false when the process ends or `limit` passes first.
  bool wait_for_output(const std::string& text, std::chrono::milliseconds limit = kPatience);

 private:
  pid_t id_ = -1;
  std::optional<int> exit_code_;
  std::filesystem::path output_;
};

// Runs a command to its end.
struct Outcome {
  int exit_code = -1;
  std::string output;
};
Outcome run(const std::vector<std::string>& command, const Process::Environment& environment = {},
            std::chrono::milliseconds limit = kPatience);

// Whether a program is in PATH.
bool installed(const std::string& program);

}  // namespace ringdown::test
