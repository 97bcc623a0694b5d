#include "server/osc_stream.h"

#include "protocol/wire/packet.h"
#include "protocol/wire/slip.h"

#include <spdlog/spdlog.h>

#include <array>
#include <arpa/inet.h>
#include <atomic>
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
#include <unistd.h>
#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int open = -1) : open_(open) {}
  Descriptor(Descriptor&& other) noexcept : open_(std::exchange(other.open_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(open_, other.open_);
    return *this;
  }
  ~Descriptor() {
    if (open_ >= 0) ::close(open_);
  }
  [[nodiscard]] int get() const { return open_; }

 private:
  int open_;
};

struct Connection {
  Descriptor socket;
  wire::Endpoint endpoint;
  wire::SlipDecoder decoder{wire::kMaxPacketBytes};
  std::vector<std::byte> unread;  // answers that wait until the client has room for them
  bool broken = false;
};

// A web page can make a browser send any bytes to a port of this computer, even valid OSC packets. But the browser
// sends the head of its HTTP request first, and that does not begin as an OSC packet does.
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

Error listen_error(wire::Endpoint endpoint) {
  return {ErrorKind::port_busy, "cannot listen for OSC by TCP on " + to_text(endpoint) + ": " + std::strerror(errno)};
}

Descriptor open_spare() { return Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)); }

}  // namespace

struct OscStream::Impl {
  Descriptor listener, waker;
  Descriptor spare;  // given up to turn a client away when there are no more descriptors
  wire::Endpoint endpoint;
  Take take;
  std::mutex mutex;  // guards `connections`; only the stream's thread adds and removes elements
  std::map<std::uint32_t, Connection> connections;
  std::uint32_t next_id = 1;
  std::jthread thread;  // last member: ends before the others are destroyed

  void run(const std::stop_token& stop);
  void accept_one();
  void turn_one_away();
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

Result<std::unique_ptr<OscStream>> OscStream::listen(wire::Endpoint endpoint) {
  auto impl = std::make_unique<Impl>();
  impl->listener = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  impl->waker = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  impl->spare = open_spare();
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(endpoint.address);
  address.sin_port = htons(endpoint.port);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  const int on = 1, socket = impl->listener.get();
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on,
               sizeof on);  // so that a restarted daemon gets its port back at once
  if (socket < 0 || impl->waker.get() < 0 || ::bind(socket, generic, size) != 0 || ::listen(socket, 8) != 0 ||
      ::getsockname(socket, generic, &size) != 0) {
    return fail(listen_error(endpoint));
  }
  impl->endpoint = {endpoint.address, ntohs(address.sin_port)};
  return std::unique_ptr<OscStream>(new OscStream(std::move(impl)));
}

std::uint16_t OscStream::port() const { return impl_->endpoint.port; }

void OscStream::start(Take take) {
  impl_->take = std::move(take);
  impl_->thread = std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->run(stop); });
}

void OscStream::send(Peer to, std::span<const std::byte> packet) {
  const std::vector<std::byte> framed = wire::slip_encode(packet);
  {
    const std::scoped_lock lock(impl_->mutex);
    const auto found = impl_->connections.find(to.connection);
    if (found == impl_->connections.end()) return;
    Connection& connection = found->second;
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
    std::vector<pollfd> watched = {{waker.get(), POLLIN, 0}, {listener.get(), POLLIN, 0}};
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
    if (watched[1].revents != 0) accept_one();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const short events = watched[i + 2].revents;
      if (events & POLLOUT) {
        const std::scoped_lock lock(mutex);
        flush(connections.at(ids[i]));
      }
      if (events & (POLLIN | POLLERR | POLLHUP)) read(ids[i]);
    }
    drop_broken();
  }
}

void OscStream::Impl::accept_one() {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  Descriptor socket(::accept4(listener.get(), reinterpret_cast<sockaddr*>(&from), &size, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (socket.get() < 0) return errno == EMFILE || errno == ENFILE ? turn_one_away() : void();
  const std::scoped_lock lock(mutex);
  if (connections.size() == kMaxConnections) return;  // closed at once
  const std::uint32_t id = next_id++;
  connections[id] = {std::move(socket), {ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)}};
}

// A client that waits to be accepted makes poll() return at once, again and again.
void OscStream::Impl::turn_one_away() {
  spdlog::warn("a TCP client of OSC was turned away: {}; raise the limit (ulimit -n)", std::strerror(errno));
  spare = Descriptor();
  Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  spare = open_spare();
  if (spare.get() < 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

void OscStream::Impl::read(std::uint32_t id) {
  Connection& connection = connections.at(id);
  std::array<std::byte, 16384> bytes;
  const ssize_t got = ::recv(connection.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  bool broken = got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR);
  for (ssize_t i = 0; i < got && !broken; ++i) {
    switch (connection.decoder.push(bytes[static_cast<std::size_t>(i)])) {
      case wire::SlipDecoder::Outcome::more:
        break;
      case wire::SlipDecoder::Outcome::fault:
        broken = true;
        break;
      case wire::SlipDecoder::Outcome::packet: {
        const std::vector<std::byte> packet = connection.decoder.take();
        broken = !begins_as_osc(packet);
        if (!broken) take(packet, {connection.endpoint, id});
        break;
      }
    }
  }
  const std::scoped_lock lock(mutex);
  connection.broken = connection.broken || broken;
}

void OscStream::Impl::drop_broken() {
  const std::scoped_lock lock(mutex);
  std::erase_if(connections, [](const auto& entry) { return entry.second.broken; });
}

}  // namespace ringdown::server
