#include "engine/base/process/child_process.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ringdown {
namespace {

constexpr int kPoll_ms = 50;
constexpr double kGrace_s = 0.5;  // from SIGTERM to SIGKILL
constexpr std::size_t kKeptErrors = 8192;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

class Pipe {
 public:
  Pipe() { good_ = ::pipe2(ends_.data(), O_CLOEXEC) == 0; }
  ~Pipe() { close_read(), close_write(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool open() const { return ends_[0] >= 0; }
  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  void close_read() { close(ends_[0]); }
  void close_write() { close(ends_[1]); }

  // Appends what can be read now to `text`. Closes the stream at its end.
  void drain(std::string& text) {
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(ends_[0], bytes.data(), bytes.size());
    if (got > 0) text.append(bytes.data(), static_cast<std::size_t>(got));
    if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) close_read();
  }

 private:
  static void close(int& descriptor) {
    if (descriptor >= 0) ::close(descriptor);
    descriptor = -1;
  }
  std::array<int, 2> ends_ = {-1, -1};
  bool good_ = false;
};

// This process's environment as "NAME=value", with the variables in `added` added or replaced.
std::vector<std::string> environment_with(const std::map<std::string, std::string>& added) {
  std::vector<std::string> all;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!added.contains(text.substr(0, text.find('=')))) all.push_back(text);
  }
  for (const auto& [name, value] : added) all.push_back(name + "=" + value);
  return all;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Runs in the child between fork and exec, where only async-signal-safe calls are allowed. When exec fails, the child
// sends errno to the parent through the pipe.
[[noreturn]] void become(char* const* command, char* const* environment, const char* folder, pid_t parent, int output,
                         int errors, int reason) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  if (*folder == '\0' || ::chdir(folder) == 0) ::execvpe(command[0], command, environment);
  const int number = errno;
  [[maybe_unused]] const ssize_t written = ::write(reason, &number, sizeof number);
  ::_exit(127);
}

// Passes the whole lines of `text` to `on_line`; an unfinished last line stays in `text`.
void hand_over(std::string& text, const std::function<void(std::string_view)>& on_line) {
  std::size_t start = 0;
  for (std::size_t end; (end = text.find('\n', start)) != std::string::npos; start = end + 1) {
    if (on_line) on_line(std::string_view(text).substr(start, end - start));
  }
  text.erase(0, start);
}

// Watches a started child until it has ended and both its streams are read.
ChildOutcome watch(pid_t id, const ChildRequest& request, Pipe& output, Pipe& errors) {
  ChildOutcome outcome;
  const double start = now_s();
  double ended_by_us = 0;
  bool killed = false;
  std::string text;
  for (int status = 0;;) {
    std::array<pollfd, 2> streams = {{{output.read_end(), POLLIN, 0}, {errors.read_end(), POLLIN, 0}}};
    ::poll(streams.data(), streams.size(), kPoll_ms);  // poll ignores closed streams, which are -1
    if (streams[0].revents != 0) output.drain(text);
    if (streams[1].revents != 0) errors.drain(outcome.errors);
    if (outcome.errors.size() > kKeptErrors) outcome.errors.erase(0, outcome.errors.size() - kKeptErrors);
    hand_over(text, request.on_line);

    const double now = now_s();
    if (ended_by_us == 0) {
      outcome.stopped = request.keep_going && !request.keep_going();
      outcome.out_of_time = request.limit_s > 0 && now - start > request.limit_s;
      if (outcome.stopped || outcome.out_of_time) ::kill(id, SIGTERM), ended_by_us = now;
    } else if (!killed && now - ended_by_us > kGrace_s) {
      ::kill(id, SIGKILL), killed = true;
    }
    rusage used{};
    const bool quiet = streams[0].revents == 0 && streams[1].revents == 0;  // a grandchild may hold the streams open
    if ((quiet || ended_by_us > 0) && ::wait4(id, &status, WNOHANG, &used) == id) {
      outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      outcome.seconds = now_s() - start;
      outcome.processor_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
      outcome.peak_mib = static_cast<double>(used.ru_maxrss) / 1024;
      return outcome;
    }
  }
}

}  // namespace

Result<ChildOutcome> run_child(const ChildRequest& request) {
  std::vector<std::string> words = request.command, variables = environment_with(request.environment);
  const std::vector<char*> command = pointers_to(words), environment = pointers_to(variables);
  const std::string folder = request.folder.string();
  Pipe output, errors, reason;
  if (!output.good() || !errors.good() || !reason.good()) {
    return fail(ErrorKind::input_output, "cannot run {}: {}", words[0], std::strerror(errno));
  }
  const pid_t parent = ::getpid(), id = ::fork();
  if (id == 0) {
    become(command.data(), environment.data(), folder.c_str(), parent, output.write_end(), errors.write_end(),
           reason.write_end());
  }
  if (id < 0) return fail(ErrorKind::input_output, "cannot run " + words[0] + ": " + std::strerror(errno));
  output.close_write(), errors.close_write(), reason.close_write();
  int number = 0;
  if (::read(reason.read_end(), &number, sizeof number) == sizeof number) {  // 0 bytes: exec closed the pipe
    ::waitpid(id, nullptr, 0);
    return fail(ErrorKind::input_output, "cannot run {}: {}", words[0], std::strerror(number));
  }
  return watch(id, request, output, errors);
}

std::string last_line(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t last = text.find_last_not_of(kBlank);
  if (last == std::string_view::npos) return "";
  text = text.substr(0, last + 1);
  const std::size_t start = text.find_last_of('\n');
  text = text.substr(start == std::string_view::npos ? 0 : start + 1);
  return std::string(text.substr(text.find_first_not_of(kBlank)));
}

Result<std::filesystem::path> find_beside(const std::string& name) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const std::filesystem::path& place : {folder / name, folder.parent_path() / name}) {
    if (::access(place.c_str(), X_OK) == 0) return place;
  }
  return fail(ErrorKind::refused, "the program {} is neither in {} nor in the folder above", name, folder.string());
}

}  // namespace ringdown
