#include "protocol/wire/endpoint.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <netinet/in.h>
#include <optional>
#include <utility>

namespace ringdown::wire {
namespace {

constexpr std::size_t kIpv4At = 12;  // where an IPv4 address begins within an Address

Error bind_error(const Endpoint& endpoint, int reason, const std::string& what) {
  if (reason == EADDRINUSE) {
    return {ErrorKind::port_busy,
            what + " port " + to_text(endpoint) +
                " is taken by another program: stop that one, or choose another port (0 takes any free one)"};
  }
  const bool not_ours = reason == EACCES || reason == EADDRNOTAVAIL;
  return {not_ours ? ErrorKind::port_busy : ErrorKind::input_output,
          formatted("cannot listen for {} on {}: {}", what, to_text(endpoint), std::strerror(reason))};
}

struct Opened {
  Descriptor socket;
  Endpoint endpoint;
  int reason = 0;  // errno if there is no socket
};

Opened open(const Endpoint& endpoint, int type) {
  SocketAddress address(endpoint);
  Opened opened{Descriptor(::socket(address.storage.ss_family, type | SOCK_CLOEXEC, 0)), endpoint};
  const int on = 1, socket = opened.socket.get();
  if (socket >= 0 && !endpoint.is_ipv4()) ::setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  // A restarted daemon gets its TCP port back at once.
  if (socket >= 0 && type == SOCK_STREAM) ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (socket < 0 || ::bind(socket, address.generic(), address.size) != 0 ||
      ::getsockname(socket, address.generic(), &address.size) != 0) {
    opened.reason = errno;
    opened.socket = Descriptor();
    return opened;
  }
  opened.endpoint = address.endpoint();
  return opened;
}

BoundSockets bound(Opened first, Opened second = {}) {
  const Endpoint endpoint = first.endpoint;
  if (!endpoint.is_ipv4()) std::swap(first, second);
  return {std::move(first.socket), std::move(second.socket), endpoint};
}

// Returns the address of the other version of IP on which a server also listens.
std::optional<Address> companion_of(const Address& address) {
  if (address == kLoopback4) return kLoopback6;
  if (address == kAny4) return kAny6;
  if (address == kAny6) return kAny4;
  return std::nullopt;
}

}  // namespace

bool Endpoint::is_ipv4() const { return std::equal(kAny4.begin(), kAny4.begin() + kIpv4At, address.begin()); }

bool Endpoint::is_loopback() const { return is_ipv4() ? address[kIpv4At] == 127 : address == kLoopback6; }

bool Endpoint::is_multicast() const {
  return is_ipv4() ? address[kIpv4At] >= 224 && address[kIpv4At] < 240 : address[0] == 0xff;
}

SocketAddress::SocketAddress(const Endpoint& endpoint) {
  if (endpoint.is_ipv4()) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(endpoint.port);
    std::memcpy(&address.sin_addr, endpoint.address.data() + kIpv4At, sizeof address.sin_addr);
    std::memcpy(&storage, &address, size = sizeof address);
  } else {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(endpoint.port);
    address.sin6_scope_id = endpoint.interface;
    std::memcpy(&address.sin6_addr, endpoint.address.data(), sizeof address.sin6_addr);
    std::memcpy(&storage, &address, size = sizeof address);
  }
}

Endpoint SocketAddress::endpoint() const {
  Endpoint endpoint;
  if (storage.ss_family == AF_INET6) {
    sockaddr_in6 address{};
    std::memcpy(&address, &storage, sizeof address);
    std::memcpy(endpoint.address.data(), &address.sin6_addr, sizeof address.sin6_addr);
    endpoint.port = ntohs(address.sin6_port);
    endpoint.interface = address.sin6_scope_id;
  } else {
    sockaddr_in address{};
    std::memcpy(&address, &storage, sizeof address);
    std::memcpy(endpoint.address.data() + kIpv4At, &address.sin_addr, sizeof address.sin_addr);
    endpoint.port = ntohs(address.sin_port);
  }
  return endpoint;
}

Result<Endpoint> resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int outcome = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (outcome != 0) {
    return fail(ErrorKind::bad_input, "cannot find the host '{}': {}", host, ::gai_strerror(outcome));
  }
  const addrinfo* chosen = found;
  for (const addrinfo* one = found; one; one = one->ai_next) {
    if (one->ai_family == AF_INET) {
      chosen = one;
      break;
    }
  }
  SocketAddress address;
  std::memcpy(&address.storage, chosen->ai_addr, chosen->ai_addrlen);
  ::freeaddrinfo(found);
  Endpoint endpoint = address.endpoint();
  endpoint.port = port;
  return endpoint;
}

std::string to_text(const Endpoint& endpoint) {
  char text[INET6_ADDRSTRLEN] = "";
  const std::string port = formatted(":{}", endpoint.port);
  if (endpoint.is_ipv4()) {
    ::inet_ntop(AF_INET, endpoint.address.data() + kIpv4At, text, sizeof text);
    return text + port;
  }
  ::inet_ntop(AF_INET6, endpoint.address.data(), text, sizeof text);
  return formatted("[{}]{}", text, port);
}

Accepted accept_one(int listener) {
  SocketAddress from;
  Descriptor socket(::accept4(listener, from.generic(), &from.size, SOCK_CLOEXEC | SOCK_NONBLOCK));
  const bool none_left = !socket.is_open() && (errno == EMFILE || errno == ENFILE);
  return {std::move(socket), from.endpoint(), none_left};
}

Result<BoundSockets> bind_one(const Endpoint& endpoint, int type, const std::string& what) {
  Opened opened = open(endpoint, type);
  if (opened.reason != 0) return fail(bind_error(endpoint, opened.reason, what));
  return bound(std::move(opened));
}

Result<BoundSockets> bind_for_server(const Endpoint& endpoint, int type, const std::string& what) {
  const auto companion = companion_of(endpoint.address);
  if (!companion) return bind_one(endpoint, type, what);
  // A port that is free for one version of IP may be taken for the other; then another free port is tried.
  for (int tries = endpoint.port == 0 ? 16 : 1;; --tries) {
    Opened first = open(endpoint, type);
    if (first.reason != 0) return fail(bind_error(endpoint, first.reason, what));
    const Endpoint beside{*companion, first.endpoint.port};
    Opened second = open(beside, type);
    if (second.reason != EADDRINUSE) return bound(std::move(first), std::move(second));
    if (tries == 1) return fail(bind_error(beside, second.reason, what));
  }
}

}  // namespace ringdown::wire
