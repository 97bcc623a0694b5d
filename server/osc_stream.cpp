#include "server/osc_stream.h"

#include "protocol/wire/framing.h"
#include "protocol/wire/packet.h"
#include "server/log.h"
#include "server/refusal_log.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <mutex>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <thread>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

struct Connection {
  wire::Descriptor socket;
  wire::Endpoint endpoint;
  wire::FrameDecoder decoder{wire::kMaxPacketBytes};
  wire::Framing framing = wire::Framing::slip;  // of the answers: the decoder's
  std::vector<std::byte> unread;                // answers that wait until the client has room for them
  bool broken = false;
};

// Returns whether a packet begins like OSC. A web page can make a browser send any bytes to a port of this computer,
// even valid OSC packets. But the browser sends the head of its HTTP request first, which does not begin like an OSC
// packet.
bool begins_as_osc(std::span<const std::byte> packet) {
  return packet.front() == std::byte{'/'} || packet.front() == std::byte{'#'};
}

// Sends as many of the waiting bytes as the client has room for, without waiting.
void flush(Connection& connection) {
  while (!connection.unread.empty()) {
    const ssize_t sent = ::send(connection.socket.get(), connection.unread.data(), connection.unread.size(),
                                MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK) connection.broken = true;
      return;
    }
    connection.unread.erase(connection.unread.begin(), connection.unread.begin() + sent);
  }
}

Error listen_error(const wire::Endpoint& endpoint) {
  return {errno == EADDRINUSE ? ErrorKind::port_busy : ErrorKind::input_output,
          "cannot listen for OSC by TCP on " + to_text(endpoint) + ": " + std::strerror(errno)};
}

wire::Descriptor open_spare() { return wire::Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)); }

}  // namespace

struct OscStream::Impl {
  wire::BoundSockets listeners;
  wire::Descriptor waker;
  wire::Descriptor spare;  // given up to turn a client away when there are no more descriptors
  Take take;
  std::mutex mutex;  // guards `connections`; only the stream's thread adds and removes elements
  std::map<std::uint32_t, Connection> connections;
  std::uint32_t next_id = 1;
  RefusalLog refusals;
  std::jthread thread;  // last member: ends before the others are destroyed

  void run(const std::stop_token& stop);
  void accept_one(int listener);
  void turn_one_away(int listener);
  void read(std::uint32_t id);
  void drop_broken();
};

OscStream::OscStream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

OscStream::~OscStream() { stop(); }

void OscStream::stop() {
  impl_->thread.request_stop();
  ::eventfd_write(impl_->waker.get(), 1);
  if (impl_->thread.joinable()) impl_->thread.join();
}

Result<std::unique_ptr<OscStream>> OscStream::listen(const wire::Endpoint& endpoint) {
  auto listeners = wire::bind_for_server(endpoint, SOCK_STREAM | SOCK_NONBLOCK, "OSC by TCP");
  if (!listeners) return fail(listeners);
  auto impl = std::make_unique<Impl>();
  impl->listeners = std::move(*listeners);
  impl->waker = wire::Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  impl->spare = open_spare();
  if (!impl->waker.is_open()) return fail(listen_error(impl->listeners.endpoint));
  for (const int listener : {impl->listeners.ipv4.get(), impl->listeners.ipv6.get()}) {
    if (listener >= 0 && ::listen(listener, 8) != 0) return fail(listen_error(impl->listeners.endpoint));
  }
  return std::unique_ptr<OscStream>(new OscStream(std::move(impl)));
}

std::uint16_t OscStream::port() const { return impl_->listeners.endpoint.port; }

void OscStream::start(Take take) {
  impl_->take = std::move(take);
  impl_->thread = std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->run(stop); });
}

void OscStream::send(Peer to, std::span<const std::byte> packet) {
  {
    const std::scoped_lock lock(impl_->mutex);
    const auto found = impl_->connections.find(to.connection);
    if (found == impl_->connections.end()) return;
    Connection& connection = found->second;
    const std::vector<std::byte> framed = wire::frame(packet, connection.framing);
    if (connection.unread.size() + framed.size() > kMaxUnreadBytes) {
      connection.broken = true;
    } else {
      connection.unread.insert(connection.unread.end(), framed.begin(), framed.end());
      flush(connection);
    }
    if (connection.unread.empty() && !connection.broken) return;
  }
  ::eventfd_write(impl_->waker.get(), 1);  // the stream's thread sends the rest, or drops the connection
}

void OscStream::Impl::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::vector<pollfd> watched = {
        {waker.get(), POLLIN, 0}, {listeners.ipv4.get(), POLLIN, 0}, {listeners.ipv6.get(), POLLIN, 0}};
    const std::size_t others = watched.size();
    std::vector<std::uint32_t> ids;
    {
      const std::scoped_lock lock(mutex);
      for (const auto& [id, connection] : connections) {
        const short events = connection.unread.empty() ? POLLIN : POLLIN | POLLOUT;
        watched.push_back({connection.socket.get(), events, 0});
        ids.push_back(id);
      }
    }
    if (::poll(watched.data(), watched.size(), -1) < 0) continue;
    if (watched[0].revents != 0) {
      eventfd_t count = 0;
      ::eventfd_read(waker.get(), &count);
    }
    for (std::size_t i = 1; i < others; ++i) {
      if (watched[i].revents != 0) accept_one(watched[i].fd);
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const short events = watched[i + others].revents;
      if (events & POLLOUT) {
        const std::scoped_lock lock(mutex);
        flush(connections.at(ids[i]));
      }
      if (events & (POLLIN | POLLERR | POLLHUP)) read(ids[i]);
    }
    drop_broken();
  }
}

void OscStream::Impl::accept_one(int listener) {
  wire::Accepted accepted = wire::accept_one(listener);
  if (accepted.out_of_descriptors) return turn_one_away(listener);
  if (!accepted.socket.is_open()) return;
  const std::scoped_lock lock(mutex);
  if (connections.size() == kMaxConnections) return;  // closed at once
  Connection& connection = connections[next_id++];
  connection.socket = std::move(accepted.socket);
  connection.endpoint = accepted.from;
}

// A client that waits to be accepted makes poll() return at once, again and again.
void OscStream::Impl::turn_one_away(int listener) {
  log_warning(formatted("an OSC client over TCP was refused: {}; raise the limit (ulimit -n)", std::strerror(errno)));
  spare = wire::Descriptor();
  wire::Descriptor(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
  spare = open_spare();
  if (!spare.is_open()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

void OscStream::Impl::read(std::uint32_t id) {
  using Decoded = wire::FrameDecoder::Outcome;
  Connection& connection = connections.at(id);
  std::array<std::byte, 16384> bytes;
  const ssize_t got = ::recv(connection.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  const bool closed = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
  bool is_osc = true;
  for (ssize_t i = 0; i < got && is_osc; ++i) {
    const Decoded outcome = connection.decoder.push(bytes[static_cast<std::size_t>(i)]);
    is_osc = outcome != Decoded::fault;
    if (outcome != Decoded::packet) continue;
    const std::vector<std::byte> packet = connection.decoder.take();
    is_osc = begins_as_osc(packet);
    if (!is_osc) break;
    {
      const std::scoped_lock lock(mutex);
      connection.framing = connection.decoder.framing();
    }
    take(packet, {connection.endpoint, id});
  }
  if (!is_osc) {
    refusals.add(
        to_text(connection.endpoint),
        "the TCP connection is closed, because it carries no OSC packets in SLIP frames or after their length");
  }
  const std::scoped_lock lock(mutex);
  connection.broken = connection.broken || closed || !is_osc;
}

void OscStream::Impl::drop_broken() {
  const std::scoped_lock lock(mutex);
  std::erase_if(connections, [](const auto& entry) { return entry.second.broken; });
}

}  // namespace ringdown::server
