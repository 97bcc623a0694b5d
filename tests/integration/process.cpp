#include "tests/integration/process.h"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

std::filesystem::path fresh_file() {
  std::string name = (std::filesystem::temp_directory_path() / "ringdown-output-XXXXXX").string();
  ::close(::mkstemp(name.data()));
  return name;
}

}  // namespace

Process::Process(const std::vector<std::string>& command, const Environment& environment) : output_(fresh_file()) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  id_ = ::fork();
  if (id_ != 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a test that is killed takes its JACK server along, which others wait for
  // Tests that run in the background have signals ignored, which their children would inherit: SIGINT and SIGQUIT by
  // the shell, SIGHUP by nohup.
  for (const int number : {SIGINT, SIGQUIT, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU}) std::signal(number, SIG_DFL);
  const int file = ::open(output_.c_str(), O_WRONLY | O_APPEND);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  ::execvp(arguments[0], arguments.data());
  ::_exit(127);
}

Process::~Process() {
  if (!wait(0ms)) {
    send_signal(SIGTERM);
    if (!wait(20s)) {
      send_signal(SIGKILL);
      wait();
    }
  }
  std::error_code ignored;
  std::filesystem::remove(output_, ignored);
}

void Process::send_signal(int signal) const {
  if (!exit_code_) ::kill(id_, signal);
}

std::optional<int> Process::wait(std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!exit_code_) {
    int status = 0;
    if (::waitpid(id_, &status, WNOHANG) == id_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else if (std::chrono::steady_clock::now() >= end) {
      break;
    } else {
      std::this_thread::sleep_for(5ms);
    }
  }
  return exit_code_;
}

long Process::memory_kb(const std::string& key) const {
  std::ifstream lines("/proc/" + std::to_string(id_) + "/status");
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(key)) return std::stol(line.substr(key.size()));
  }
  return 0;
}

void Process::forget_peak() const { std::ofstream("/proc/" + std::to_string(id_) + "/clear_refs") << "5"; }

std::string Process::output() const {
  std::ostringstream text;
  text << std::ifstream(output_).rdbuf();
  return text.str();
}

bool Process::wait_for_output(const std::string& text, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (output().find(text) == std::string::npos) {
    if (wait(0ms) || std::chrono::steady_clock::now() >= end) return output().find(text) != std::string::npos;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

Outcome run(const std::vector<std::string>& command, const Process::Environment& environment,
            std::chrono::milliseconds limit) {
  Process process(command, environment);
  const auto code = process.wait(limit);
  return {code.value_or(-1), process.output()};
}

bool installed(const std::string& program) {
  std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace ringdown::test
