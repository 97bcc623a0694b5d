#include "server/log.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <ctime>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace ringdown::server {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

bool waits_for_room(int descriptor, milliseconds patience) {
  pollfd room{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return ::poll(&room, 1, static_cast<int>(patience.count())) > 0 && room.revents == POLLOUT;
}

std::atomic<Log*> current = nullptr;

}  // namespace

// O_NONBLOCK belongs to the open file, which we share with our parent and its other children: a shell misbehaves if its
// terminal suddenly does not block. So a pipe or a terminal is opened once more, for us alone.
LineWriter::LineWriter(int descriptor) : descriptor_(descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return;
  if (S_ISSOCK(status.st_mode)) kind_ = Kind::socket;
  if (!S_ISFIFO(status.st_mode) && !S_ISCHR(status.st_mode)) return;
  const std::string path = formatted("/proc/self/fd/{}", descriptor);
  const int again = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (again < 0) return;  // another user's pipe, for example; write_some() asks for room then
  descriptor_ = again;
  owns_ = true;
  kind_ = Kind::nonblocking;
}

LineWriter::~LineWriter() {
  if (owns_) ::close(descriptor_);
}

// If the descriptor may block, a write of PIPE_BUF bytes or less does not block once poll() has reported room, unless
// another process takes the room in between.
std::size_t LineWriter::write_some(std::string_view text) {
  if (kind_ == Kind::other) {
    if (!waits_for_room(descriptor_, milliseconds(0))) return 0;
    text = text.substr(0, PIPE_BUF);
  }
  for (;;) {
    const ssize_t written = kind_ == Kind::socket
                                ? ::send(descriptor_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                                : ::write(descriptor_, text.data(), text.size());
    if (written >= 0) return static_cast<std::size_t>(written);
    if (errno != EINTR) return 0;
  }
}

bool LineWriter::put(std::string_view text, milliseconds patience) {
  const auto end = Clock::now() + patience;
  std::string all = std::exchange(rest_, {});
  const std::size_t old = all.size();
  all += text;
  std::size_t done = 0;
  while (done < all.size()) {
    const std::size_t written = write_some(std::string_view(all).substr(done));
    done += written;
    if (written > 0) continue;
    const auto left = std::chrono::ceil<milliseconds>(end - Clock::now());
    if (left <= milliseconds(0) || !waits_for_room(descriptor_, left)) break;
  }
  const bool begun = done > old;
  rest_ = begun ? all.substr(done) : all.substr(done, old - done);
  return begun;
}

void LineWriter::report(milliseconds patience) {
  if (dropped_ == 0) return;
  const std::string sentence =
      formatted("{}{} left out, because the log was not read\n", dropped_, dropped_ == 1 ? " line was" : " lines were");
  if (put(sentence, patience)) dropped_ = 0;
}

void LineWriter::write(std::string_view line, milliseconds patience) {
  const std::scoped_lock lock(mutex_);
  report(patience);
  if (dropped_ > 0 || !put(line, patience)) ++dropped_;
}

void LineWriter::report_dropped() {
  const std::scoped_lock lock(mutex_);
  if (!rest_.empty()) put("", {});
  report({});
}

std::string fixed(double value, int decimals) { return formatted("{:.{}f}", value, decimals); }

// Colours are for the level's name, as terminals know them.
void Log::write(const char* level, const char* color, std::string_view sentence) {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto rest = std::chrono::floor<milliseconds>(now.time_since_epoch()) % std::chrono::seconds(1);
  std::tm local{};
  ::localtime_r(&seconds, &local);
  std::string line = formatted("{:02}:{:02}:{:02}.{:03} ", local.tm_hour, local.tm_min, local.tm_sec, rest.count());
  line += colored_ ? formatted("{}{}\033[m", color, level) : level;
  writer_.write(line.append(" ").append(sentence).append("\n"));
}

void log_info(std::string_view sentence) {
  if (Log* const log = current) log->write("info", "\033[32m", sentence);
}

void log_warning(std::string_view sentence) {
  if (Log* const log = current) log->write("warning", "\033[33m\033[1m", sentence);
}

Log::Log(int descriptor) : writer_(descriptor), colored_(::isatty(descriptor) == 1) { current = this; }

Log::~Log() { current = nullptr; }

protocol::ExitCode Log::complain(const Error& error) {
  writer_.write(formatted("{}: {}\n", program_invocation_short_name, error.message), std::chrono::seconds(1));
  return protocol::exit_code_of(error.kind);
}

}  // namespace ringdown::server
