// Addresses of IPv4 and IPv6 with their ports, and sockets bound to them. [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/descriptor.h"

#include <array>
#include <cstdint>
#include <string>
#include <sys/socket.h>

namespace ringdown::wire {

// An address as IPv6 writes it. The IPv4 address a.b.c.d is ::ffff:a.b.c.d (RFC 4291, section 2.5.5.2).
using Address = std::array<std::uint8_t, 16>;

constexpr Address ipv4(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d) {
  return {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, a, b, c, d};
}

inline constexpr Address kLoopback4 = ipv4(127, 0, 0, 1), kAny4 = ipv4(0, 0, 0, 0);
inline constexpr Address kLoopback6 = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, kAny6 = {};

struct Endpoint {
  Address address = kLoopback4;
  std::uint16_t port = 0;
  std::uint32_t interface = 0;  // the number of the network interface, for link-local IPv6 addresses (fe80::...)
  friend bool operator==(const Endpoint&, const Endpoint&) = default;

  [[nodiscard]] bool is_ipv4() const;
  [[nodiscard]] bool is_loopback() const;  // true if only this computer can reach the endpoint
  [[nodiscard]] bool is_multicast() const;
};

// Looks a host name up, or parses an address. If a host has both kinds of address, returns IPv4. May ask a name server.
Result<Endpoint> resolve(const std::string& host, std::uint16_t port);

// Returns "127.0.0.1:7770" or "[::1]:7770".
std::string to_text(const Endpoint& endpoint);

// An endpoint in the form for system calls.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;

  SocketAddress() = default;
  explicit SocketAddress(const Endpoint& endpoint);
  [[nodiscard]] Endpoint endpoint() const;
  [[nodiscard]] sockaddr* generic() { return reinterpret_cast<sockaddr*>(&storage); }
  [[nodiscard]] const sockaddr* generic() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

// One or two bound sockets, one for each version of IP.
struct BoundSockets {
  Descriptor ipv4, ipv6;
  Endpoint endpoint;  // endpoint of the first socket; a second socket has an equal port

  // The socket that reaches an endpoint.
  [[nodiscard]] int to(const Endpoint& peer) const { return (peer.is_ipv4() ? ipv4 : ipv6).get(); }
};

// Binds a socket of `type` (SOCK_DGRAM or SOCK_STREAM) to the endpoint; port 0 means any free port. Fails with
// ErrorKind::port_busy if the port is not available, or input_output; the sentence begins with `what`, such as "OSC".
Result<BoundSockets> bind_one(const Endpoint& endpoint, int type, const std::string& what);

// Binds as a server should. 127.0.0.1 also binds ::1, on an equal port, because `localhost` may mean either; 0.0.0.0
// also binds ::, and :: also binds 0.0.0.0. On a computer without IPv6, only IPv4 is bound.
Result<BoundSockets> bind_for_server(const Endpoint& endpoint, int type, const std::string& what);

struct Accepted {
  Descriptor socket;  // not open: no connection is waiting, or no descriptor is free
  Endpoint from;
  bool out_of_descriptors = false;  // a connection is waiting, and poll() will report it again at once
};

// Accepts a connection if one is waiting. The accepted socket is non-blocking.
Accepted accept_one(int listener);

}  // namespace ringdown::wire
