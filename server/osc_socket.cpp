#include "server/osc_socket.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
#include <utility>

namespace ringdown::server {
namespace {

constexpr int kReceiveBuffer = 4 << 20;

sockaddr_in to_sockaddr(Endpoint endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(endpoint.address);
  address.sin_port = htons(endpoint.port);
  return address;
}

Endpoint from_sockaddr(const sockaddr_in& address) { return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)}; }

Error bind_error(Endpoint endpoint, int reason) {
  if (reason == EADDRINUSE) {
    return {"OSC port " + to_text(endpoint) +
            " is taken by another program: stop that one, or choose another port (0 takes any free one)"};
  }
  return {"cannot listen for OSC on " + to_text(endpoint) + ": " + std::strerror(reason)};
}

// Only root may exceed net.core.rmem_max; either call may fail without harm.
void raise_receive_buffer(int socket) {
  if (::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBuffer, sizeof kReceiveBuffer) == 0) return;
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
}

// Since the kernel received what `header` describes; 0 where it does not say, or the clock was set meanwhile.
double age_s(msghdr& header) {
  const cmsghdr* const control = CMSG_FIRSTHDR(&header);
  if (!control || control->cmsg_level != SOL_SOCKET || control->cmsg_type != SCM_TIMESTAMPNS) return 0;
  timespec then{}, now{};
  std::memcpy(&then, CMSG_DATA(control), sizeof then);
  ::clock_gettime(CLOCK_REALTIME, &now);
  const double age =
      static_cast<double>(now.tv_sec - then.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec - then.tv_nsec);
  constexpr double kOldest_s = 1;
  return age > 0 && age < kOldest_s ? age : 0;
}

void close_if_open(int& descriptor) {
  if (const int open = std::exchange(descriptor, -1); open >= 0) ::close(open);
}

}  // namespace

Result<Endpoint> resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int outcome = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (outcome != 0) {
    return fail("cannot find the host '" + host + "': " + ::gai_strerror(outcome));
  }
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  ::freeaddrinfo(found);
  return Endpoint{ntohl(address.sin_addr.s_addr), port};
}

std::string to_text(Endpoint endpoint) {
  const in_addr address{htonl(endpoint.address)};
  char text[INET_ADDRSTRLEN] = "";
  ::inet_ntop(AF_INET, &address, text, sizeof text);
  return std::string(text) + ":" + std::to_string(endpoint.port);
}

Result<OscSocket> OscSocket::bind(Endpoint endpoint) {
  OscSocket opened(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), endpoint);
  if (opened.socket_ < 0 || opened.waker_ < 0) return fail(bind_error(endpoint, errno));
  sockaddr_in address = to_sockaddr(endpoint);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (::bind(opened.socket_, generic, size) != 0 || ::getsockname(opened.socket_, generic, &size) != 0) {
    return fail(bind_error(endpoint, errno));
  }
  raise_receive_buffer(opened.socket_);
  const int on = 1;
  ::setsockopt(opened.socket_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  opened.endpoint_ = from_sockaddr(address);
  return opened;
}

OscSocket::OscSocket(OscSocket&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      waker_(std::exchange(other.waker_, -1)),
      endpoint_(other.endpoint_),
      room_(std::move(other.room_)) {}

OscSocket& OscSocket::operator=(OscSocket&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(waker_, other.waker_);
  std::swap(endpoint_, other.endpoint_);
  std::swap(room_, other.room_);
  return *this;
}

OscSocket::~OscSocket() {
  close_if_open(socket_);
  close_if_open(waker_);
}

std::size_t OscSocket::receive_buffer_bytes() const {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  ::getsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, &size);
  return static_cast<std::size_t>(bytes) / 2;  // the kernel reports twice what it uses for data
}

bool OscSocket::receive(Datagram& datagram, std::chrono::milliseconds timeout) {
  pollfd watched[] = {{socket_, POLLIN, 0}, {waker_, POLLIN, 0}};
  if (::poll(watched, 2, static_cast<int>(timeout.count())) <= 0) return false;
  if (watched[1].revents != 0) {
    eventfd_t count = 0;
    ::eventfd_read(waker_, &count);
    return false;
  }
  sockaddr_in from{};
  iovec room{room_.data(), room_.size()};
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(timespec))> control{};
  msghdr header{};
  header.msg_name = &from;
  header.msg_namelen = sizeof from;
  header.msg_iov = &room;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  const ssize_t received = ::recvmsg(socket_, &header, MSG_DONTWAIT);
  datagram.bytes.assign(room_.begin(), room_.begin() + std::max<ssize_t>(received, 0));
  datagram.from = from_sockaddr(from);
  datagram.age_s = received > 0 ? age_s(header) : 0;
  return received >= 0;
}

void OscSocket::wake() noexcept { ::eventfd_write(waker_, 1); }

Result<void> OscSocket::send_to(Endpoint to, std::span<const std::byte> bytes) {
  const sockaddr_in address = to_sockaddr(to);
  const ssize_t sent =
      ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  if (sent < 0) return fail("cannot send OSC to " + to_text(to) + ": " + std::strerror(errno));
  return {};
}

}  // namespace ringdown::server
