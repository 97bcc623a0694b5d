#include "server/service_notice.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace ringdown::server {
namespace {

// WATCHDOG_PID names the process that the watchdog is for; a process that has inherited its environment must not
// answer.
std::chrono::microseconds watchdog_time() {
  const char* time = std::getenv("WATCHDOG_USEC");
  const char* process = std::getenv("WATCHDOG_PID");
  if (!time || (process && std::atol(process) != ::getpid())) return {};
  return std::chrono::microseconds(std::max(0LL, std::atoll(time)));
}

}  // namespace

ServiceNotice::ServiceNotice() {
  const char* address = std::getenv("NOTIFY_SOCKET");
  if (!address || (address[0] != '/' && address[0] != '@') || std::strlen(address) >= sizeof(sockaddr_un::sun_path)) {
    return;
  }
  address_ = address;
  if (address_[0] == '@') address_[0] = '\0';
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  interval_ = watchdog_time() / 2;
}

ServiceNotice::~ServiceNotice() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotice::turn(std::uint64_t frames, std::uint64_t beats) {
  if (!ready_ && frames > 0) {
    ready_ = true;
    say("READY=1\nSTATUS=sound runs");
  }
  const auto now = Clock::now();
  if (interval_ > Clock::duration::zero() && now >= next_ && beats != last_beats_) {
    last_beats_ = beats;
    next_ = now + interval_;
    say("WATCHDOG=1");
  }
}

void ServiceNotice::stopping() { say("STOPPING=1\nSTATUS=stopping"); }

void ServiceNotice::say(std::string_view what) const {
  if (socket_ < 0) return;
  sockaddr_un to{.sun_family = AF_UNIX};
  std::memcpy(to.sun_path, address_.data(), address_.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  static_cast<void>(::sendto(socket_, what.data(), what.size(), MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&to), size));
}

}  // namespace ringdown::server
