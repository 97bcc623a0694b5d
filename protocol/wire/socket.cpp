#include "protocol/wire/socket.h"

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

namespace ringdown::wire {
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
    return {ErrorKind::port_busy,
            "OSC port " + to_text(endpoint) +
                " is taken by another program: stop that one, or choose another port (0 takes any free one)"};
  }
  return {ErrorKind::port_busy, "cannot listen for OSC on " + to_text(endpoint) + ": " + std::strerror(reason)};
}

// Only root may exceed net.core.rmem_max; either call may fail without harm.
void raise_receive_buffer(int socket) {
  if (::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBuffer, sizeof kReceiveBuffer) == 0) return;
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
}

// Since the kernel received what `header` describes; 0 where it does not say, or the clock was set meanwhile.
double age_s(const msghdr& header) {
  const cmsghdr* const control = CMSG_FIRSTHDR(&header);
  if (!control || control->cmsg_level != SOL_SOCKET || control->cmsg_type != SCM_TIMESTAMPNS) return 0;
  timespec then{}, now{};
  std::memcpy(&then, CMSG_DATA(control), sizeof then);
  ::clock_gettime(CLOCK_REALTIME, &now);
  const double age =
      static_cast<double>(now.tv_sec - then.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec - then.tv_nsec);
  constexpr double kMaxAge_s = 1;
  return age > 0 && age < kMaxAge_s ? age : 0;
}

void close_if_open(int& descriptor) {
  if (const int open = std::exchange(descriptor, -1); open >= 0) ::close(open);
}

}  // namespace

// Datagrams are received in batches: recvmmsg() hands over all that wait, up to kMaxBatch, in one system call, which in
// a flood saves most of the time that receiving takes. The kernel stamps each datagram when it arrives
// (SO_TIMESTAMPNS), so a message's time does not depend on when this thread came to read it.
//
// A batch reserves memory for the largest datagrams, but touches no more of it than the received ones fill.
struct OscSocket::Batch {
  static constexpr std::size_t kMaxBatch = 32, kMaxDatagramBytes = 65536;

  struct Slot {
    sockaddr_in from;
    iovec room;
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(timespec))> control;
  };
  std::unique_ptr<std::byte[]> bytes{new std::byte[kMaxBatch * kMaxDatagramBytes]};
  std::array<Slot, kMaxBatch> slots{};
  std::array<mmsghdr, kMaxBatch> headers{};
  std::size_t next = 0, count = 0;

  // False when there is nothing.
  bool fetch(int socket) {
    for (std::size_t i = 0; i < kMaxBatch; ++i) {
      Slot& slot = slots[i];
      slot.room = {bytes.get() + i * kMaxDatagramBytes, kMaxDatagramBytes};
      headers[i].msg_hdr = {.msg_name = &slot.from,
                            .msg_namelen = sizeof slot.from,
                            .msg_iov = &slot.room,
                            .msg_iovlen = 1,
                            .msg_control = slot.control.data(),
                            .msg_controllen = slot.control.size(),
                            .msg_flags = 0};
    }
    next = 0;
    count = static_cast<std::size_t>(std::max(0, ::recvmmsg(socket, headers.data(), kMaxBatch, MSG_DONTWAIT, nullptr)));
    return count > 0;
  }

  void give(Datagram& datagram) {
    const Slot& slot = slots[next];
    const mmsghdr& header = headers[next++];
    const auto* const first = static_cast<const std::byte*>(slot.room.iov_base);
    datagram.bytes.assign(first, first + header.msg_len);
    datagram.from = from_sockaddr(slot.from);
    datagram.age_s = age_s(header.msg_hdr);
  }
};

OscSocket::OscSocket(int socket, int waker, Endpoint endpoint) : socket_(socket), waker_(waker), endpoint_(endpoint) {}

Result<Endpoint> resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int outcome = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (outcome != 0) {
    return fail(ErrorKind::bad_input, "cannot find the host '" + host + "': " + ::gai_strerror(outcome));
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
      batch_(std::move(other.batch_)) {}

OscSocket& OscSocket::operator=(OscSocket&& other) noexcept {
  std::swap(socket_, other.socket_);
  std::swap(waker_, other.waker_);
  std::swap(endpoint_, other.endpoint_);
  std::swap(batch_, other.batch_);
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
  if (!batch_) batch_ = std::make_unique<Batch>();
  if (batch_->next == batch_->count) {
    pollfd watched[] = {{socket_, POLLIN, 0}, {waker_, POLLIN, 0}};
    if (::poll(watched, 2, static_cast<int>(timeout.count())) <= 0) return false;
    if (watched[1].revents != 0) {
      eventfd_t count = 0;
      ::eventfd_read(waker_, &count);
      return false;
    }
    if (!batch_->fetch(socket_)) return false;
  }
  batch_->give(datagram);
  return true;
}

void OscSocket::wake() noexcept { ::eventfd_write(waker_, 1); }

Result<void> OscSocket::send_to(Endpoint to, std::span<const std::byte> bytes) {
  const sockaddr_in address = to_sockaddr(to);
  const ssize_t sent =
      ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  if (sent < 0) return fail(ErrorKind::input_output, "cannot send OSC to " + to_text(to) + ": " + std::strerror(errno));
  return {};
}

}  // namespace ringdown::wire
