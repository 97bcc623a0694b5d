#include "engine/base/process/helper_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <utility>
#include <unistd.h>

namespace ringdown {
namespace {

constexpr int kAsk_ms = 50;
constexpr double kLastWords_s = 0.5;               // longest time between the end of output and the end of the program
constexpr std::size_t kMaxRequest = 100'000;       // bytes; less than a socket holds, so that sending never waits
constexpr std::size_t kMaxReport = 200;            // bytes of a stage's name
constexpr rlim_t kMaxFileBytes = rlim_t{1} << 20;  // size of files that the program may write
constexpr rlim_t kMaxOpenFiles = 64;
constexpr double kNearlyAll = 0.7;  // share of the memory limit from which a crash counts as out of memory

enum class Kind : std::uint64_t { kAnswer, kReport };

struct Head {
  Kind kind = Kind::kAnswer;
  std::uint64_t bytes = 0;
};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Returns the processor time of all threads of another process.
double processor_s_of(pid_t id) {
  clockid_t clock{};
  timespec time{};
  if (::clock_getcpuclockid(id, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<char*> words_of(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

void limit(int resource, rlim_t max) {
  const rlimit both{max, max};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

// Runs in the child between fork and exec, where only async-signal-safe calls are allowed.
[[noreturn]] void become(char* const* command, char* const* environment, pid_t parent, int pipe,
                         [[maybe_unused]] rlim_t memory_bytes) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // A terminal sends these to both processes: the parent decides.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::signal(signal, SIG_IGN);
  ::signal(SIGXFSZ, SIG_DFL);  // our programs ignore this signal, but a child that writes too much should end
#ifndef RINGDOWN_SANITIZE      // sanitizers' shadow memory would count
  limit(RLIMIT_DATA, memory_bytes);
#endif
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, kMaxFileBytes);
  limit(RLIMIT_NOFILE, kMaxOpenFiles);
  const int nothing = ::open("/dev/null", O_WRONLY);
  ::dup2(pipe, STDIN_FILENO);
  ::dup2(pipe, STDOUT_FILENO);
  ::dup2(nothing, STDERR_FILENO);
  ::execve(command[0], command, environment);
  ::_exit(127);
}

// Reads one report: a fraction and the stage's name, which may have arbitrary bytes.
void take_report(std::string_view bytes, std::string& stage, double& fraction) {
  if (bytes.size() < sizeof fraction) return;
  std::memcpy(&fraction, bytes.data(), sizeof fraction);
  fraction = fraction >= 0 && fraction <= 1 ? fraction : 0;
  stage = bytes.substr(sizeof fraction);
  std::replace_if(
      stage.begin(), stage.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
}

}  // namespace

Result<void> HelperProcess::start(std::vector<std::string> command, const std::vector<std::string>& added,
                                  const HelperLimits& limits) {
  stop();
  limits_ = limits;
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail(ErrorKind::input_output, "cannot run {}: {}", command[0], std::strerror(errno));
  }
  std::vector<std::string> variables = added;
  for (char** entry = environ; *entry != nullptr; ++entry)
    variables.emplace_back(*entry);  // the first variable of a name counts
  const std::vector<char*> words = words_of(command), environment = words_of(variables);
  const pid_t parent = ::getpid(), id = ::fork();
  if (id == 0) become(words.data(), environment.data(), parent, ends[1], limits.memory_bytes);
  const int error = errno;
  ::close(ends[1]);
  if (id < 0) {
    ::close(ends[0]);
    return fail(ErrorKind::input_output, "cannot run {}: {}", command[0], std::strerror(error));
  }
  id_ = id;
  pipe_ = ends[0];
  return {};
}

void HelperProcess::stop() {
  if (id_ <= 0) return;
  ::kill(id_, SIGKILL);
  ::waitpid(id_, nullptr, 0);
  ::close(pipe_);
  id_ = 0;
  pipe_ = -1;
}

HelperAnswer HelperProcess::ended(HelperEnd end) {
  stop();
  return {.end = end};
}

// Called after the program's output has ended. Deduces the reason from the exit status.
HelperAnswer HelperProcess::ended_by_itself() {
  int status = 0;
  rusage used{};
  const double from = seconds_now();
  pid_t waited = 0;
  while ((waited = ::wait4(id_, &status, WNOHANG, &used)) == 0 && seconds_now() - from < kLastWords_s) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (waited != id_) return ended(HelperEnd::silent);
  ::close(pipe_);
  id_ = 0;
  pipe_ = -1;
  if (WIFEXITED(status)) {
    return {.end = WEXITSTATUS(status) == kHelperOutOfMemory ? HelperEnd::out_of_memory : HelperEnd::silent};
  }
  const double peak_bytes = 1024.0 * static_cast<double>(used.ru_maxrss);
  const bool no_memory = WTERMSIG(status) == SIGKILL ||  // by the kernel, when the whole computer had too little
                         peak_bytes > kNearlyAll * static_cast<double>(limits_.memory_bytes);
  return {.end = no_memory ? HelperEnd::out_of_memory : HelperEnd::crashed, .bytes = "", .signal = WTERMSIG(status)};
}

// Takes frames off `text` as soon as they are complete. Only the last report is kept, and the length that an answer
// claims is checked before its bytes are read.
HelperAnswer HelperProcess::ask(std::string_view request, const Progress& progress) {
  const Head head{Kind::kAnswer, request.size()};
  std::string text(reinterpret_cast<const char*>(&head), sizeof head);
  text += request;
  if (request.size() > kMaxRequest) return ended(HelperEnd::silent);
  if (::send(pipe_, text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size())) {
    return ended_by_itself();
  }
  text.clear();
  std::vector<char> part(std::size_t{1} << 18);
  std::string stage;
  double fraction = 0;
  const double from = seconds_now(), processor_from = processor_s_of(id_);
  double asked = from;
  for (;;) {
    pollfd one{pipe_, POLLIN, 0};
    ::poll(&one, 1, kAsk_ms);
    if (one.revents != 0) {
      const ssize_t got = ::recv(pipe_, part.data(), part.size(), MSG_DONTWAIT);
      if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return ended_by_itself();
      if (got > 0) text.append(part.data(), static_cast<std::size_t>(got));
    }
    Head next;
    while (text.size() >= sizeof next) {
      std::memcpy(&next, text.data(), sizeof next);
      const bool report = next.kind == Kind::kReport;
      if (!report && next.kind != Kind::kAnswer) return ended(HelperEnd::silent);
      if (report && next.bytes > kMaxReport) return ended(HelperEnd::silent);
      if (next.bytes > limits_.answer_bytes) return ended(HelperEnd::too_long);
      if (text.size() < sizeof next + next.bytes) break;
      if (!report) {
        text.erase(0, sizeof next);
        if (text.size() > next.bytes) return ended(HelperEnd::silent);
        return {.end = HelperEnd::answered, .bytes = std::move(text)};
      }
      take_report(std::string_view(text).substr(sizeof next, next.bytes), stage, fraction);
      text.erase(0, sizeof next + next.bytes);
      if (progress && !progress(stage, fraction)) return ended(HelperEnd::stopped);
    }
    const double now = seconds_now();
    if (now - asked < 1e-3 * kAsk_ms) continue;
    asked = now;
    if (progress && !progress(stage, fraction)) return ended(HelperEnd::stopped);
    const bool late = processor_s_of(id_) - processor_from > limits_.processor_s || now - from > limits_.wall_s();
    if (late) return ended(HelperEnd::out_of_time);
  }
}

double HelperProcess::processor_s() const { return running() ? processor_s_of(id_) : 0; }

namespace {

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool read_all(int descriptor, char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t got = ::read(descriptor, bytes, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

void send_frame(int descriptor, Kind kind, std::string_view bytes) {
  const Head head{kind, bytes.size()};
  write_all(descriptor, {reinterpret_cast<const char*>(&head), sizeof head}) && write_all(descriptor, bytes);
}

}  // namespace

HelperPipe::HelperPipe() : pipe_(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3)) {
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::close(nothing);
}

bool HelperPipe::next(std::string& request) const {
  Head head;
  if (!read_all(pipe_, reinterpret_cast<char*>(&head), sizeof head) || head.bytes > kMaxRequest) return false;
  request.resize(head.bytes);
  return read_all(pipe_, request.data(), request.size());
}

void HelperPipe::report(std::string_view stage, double fraction) const {
  std::string bytes(reinterpret_cast<const char*>(&fraction), sizeof fraction);
  bytes += stage.substr(0, kMaxReport - sizeof fraction);
  send_frame(pipe_, Kind::kReport, bytes);
}

void HelperPipe::answer(std::string_view bytes) const { send_frame(pipe_, Kind::kAnswer, bytes); }

}  // namespace ringdown
