#include "protocol/wire/socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <time.h>
#include <utility>

namespace ringdown::wire {
namespace {

constexpr int kReceiveBuffer = 4 << 20;

// Only root may exceed net.core.rmem_max; either call may fail without harm.
void raise_receive_buffer(int socket) {
  if (::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &kReceiveBuffer, sizeof kReceiveBuffer) == 0) return;
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
}

// Returns the time since the kernel received the datagram; 0 if `header` has no timestamp or the clock was changed.
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

}  // namespace

// Receives datagrams in batches: recvmmsg() returns all waiting datagrams, up to kMaxBatch, in one system call, which
// saves most of the receiving time in a flood. The kernel stamps each datagram on arrival (SO_TIMESTAMPNS), so a
// message's time does not depend on when this thread reads it.
//
// A batch reserves memory for the largest datagrams, but touches only the part that received datagrams fill.
struct OscSocket::Batch {
  static constexpr std::size_t kMaxBatch = 32, kMaxDatagramBytes = 65536;

  struct Slot {
    SocketAddress from;
    iovec room;
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(timespec))> control;
  };
  std::unique_ptr<std::byte[]> bytes{new std::byte[kMaxBatch * kMaxDatagramBytes]};
  std::array<Slot, kMaxBatch> slots{};
  std::array<mmsghdr, kMaxBatch> headers{};
  std::size_t next = 0, count = 0;
  std::size_t from = 0;  // origin of the batch: 0 the IPv4 socket, 1 the IPv6 socket

  // Returns false if no datagram is waiting.
  bool fetch(int socket) {
    for (std::size_t i = 0; i < kMaxBatch; ++i) {
      Slot& slot = slots[i];
      slot.room = {bytes.get() + i * kMaxDatagramBytes, kMaxDatagramBytes};
      headers[i].msg_hdr = {.msg_name = &slot.from.storage,
                            .msg_namelen = sizeof slot.from.storage,
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
    datagram.from = slot.from.endpoint();
    datagram.age_s = age_s(header.msg_hdr);
  }
};

OscSocket::OscSocket(BoundSockets sockets, Descriptor waker) : sockets_(std::move(sockets)), waker_(std::move(waker)) {
  const int on = 1;
  for (const int socket : {sockets_.ipv4.get(), sockets_.ipv6.get()}) {
    if (socket < 0) continue;
    raise_receive_buffer(socket);
    ::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  }
}

OscSocket::OscSocket(OscSocket&& other) noexcept = default;
OscSocket& OscSocket::operator=(OscSocket&& other) noexcept = default;
OscSocket::~OscSocket() = default;

Result<OscSocket> OscSocket::open(Result<BoundSockets> sockets) {
  if (!sockets) return fail(sockets);
  Descriptor waker(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!waker.is_open()) {
    return fail(ErrorKind::port_busy, "cannot listen for OSC on {}: {}", to_text(sockets->endpoint),
                std::strerror(errno));
  }
  return OscSocket(std::move(*sockets), std::move(waker));
}

Result<OscSocket> OscSocket::bind(const Endpoint& endpoint) { return open(bind_one(endpoint, SOCK_DGRAM, "OSC")); }

Result<OscSocket> OscSocket::serve(const Endpoint& endpoint) {
  return open(bind_for_server(endpoint, SOCK_DGRAM, "OSC"));
}

Result<OscSocket> OscSocket::reach(const Endpoint& server) {
  if (server.is_loopback()) return bind({.address = server.address});
  return bind({.address = server.is_ipv4() ? kAny4 : kAny6});
}

std::size_t OscSocket::receive_buffer_bytes() const {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  ::getsockopt(sockets_.to(sockets_.endpoint), SOL_SOCKET, SO_RCVBUF, &bytes, &size);
  return static_cast<std::size_t>(bytes) / 2;  // the kernel reports twice the size that it uses for data
}

bool OscSocket::receive(Datagram& datagram, std::chrono::milliseconds timeout) {
  if (!batch_) batch_ = std::make_unique<Batch>();
  if (batch_->next == batch_->count && !fetch(timeout)) return false;
  batch_->give(datagram);
  return true;
}

// Fetches the waiting datagrams of one socket; if both sockets have some, of the one that was not served last.
bool OscSocket::fetch(std::chrono::milliseconds timeout) {
  // poll() ignores negative descriptors, such as that of a missing socket.
  pollfd watched[] = {{sockets_.ipv4.get(), POLLIN, 0}, {sockets_.ipv6.get(), POLLIN, 0}, {waker_.get(), POLLIN, 0}};
  if (::poll(watched, std::size(watched), static_cast<int>(timeout.count())) <= 0) return false;
  if (watched[2].revents != 0) {
    eventfd_t count = 0;
    ::eventfd_read(waker_.get(), &count);
    return false;
  }
  const std::size_t first = 1 - batch_->from, ready = watched[first].revents != 0 ? first : batch_->from;
  batch_->from = ready;
  return batch_->fetch(watched[ready].fd);
}

void OscSocket::wake() noexcept { ::eventfd_write(waker_.get(), 1); }

Result<void> OscSocket::send_to(const Endpoint& to, std::span<const std::byte> bytes) {
  const int socket = sockets_.to(to);
  const SocketAddress address(to);
  if (socket < 0)
    return fail(ErrorKind::input_output, "cannot send OSC to {} from {}", to_text(to), to_text(endpoint()));
  const ssize_t sent = ::sendto(socket, bytes.data(), bytes.size(), 0, address.generic(), address.size);
  if (sent < 0) return fail(ErrorKind::input_output, "cannot send OSC to {}: {}", to_text(to), std::strerror(errno));
  return {};
}

}  // namespace ringdown::wire
