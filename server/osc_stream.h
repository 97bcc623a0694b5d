// OSC over TCP: for clients that must not lose a packet, or that UDP does not reach. A client may frame packets by SLIP
// or by their lengths (framing.h), and is answered in its own framing. The daemon opens it with --tcp, on this computer
// only unless --address says otherwise.
//
//   auto stream = OscStream::listen({.port = 7771});
//   (*stream)->start([](std::span<const std::byte> packet, Peer from) { ... });   // on the stream's thread
//   (*stream)->send(peer, answer);                                                // on any thread
//
// The stream's own thread accepts connections, reads and writes. It closes the connection of a client that sends bytes
// in neither framing, a packet of more than wire::kMaxPacketBytes, or a packet that begins with neither / nor # (from a
// web page in a browser), and logs this. It also closes the connection of a client that leaves more than
// kMaxUnreadBytes of answers unread. A connection beyond kMaxConnections is closed at once.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/endpoint.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace ringdown::server {

inline constexpr std::size_t kMaxConnections = 16;
inline constexpr std::size_t kMaxUnreadBytes = std::size_t{1} << 20;  // answers waiting for one client

// The sender of a packet, who gets its answers.
struct Peer {
  wire::Endpoint endpoint;
  std::uint32_t connection = 0;  // number given by OscStream; 0: the packet arrived by UDP
  friend bool operator==(const Peer&, const Peer&) = default;
};

class OscStream {
 public:
  // Opens the port; 0 takes any free one. Fails with ErrorKind::port_busy. [main]
  static Result<std::unique_ptr<OscStream>> listen(const wire::Endpoint& endpoint);
  ~OscStream();

  [[nodiscard]] std::uint16_t port() const;

  // Starts the stream's thread, which calls `take` for each packet. While `take` waits, nothing is read from any
  // client. Call once. [main]
  using Take = std::function<void(std::span<const std::byte> packet, Peer from)>;
  void start(Take take);

  // Ends the thread. `take` is not called after this function has returned. [main]
  void stop();

  // Sends a packet to a client, now or when the client has read earlier packets. Does nothing if the client has gone.
  // [any thread]
  void send(Peer to, std::span<const std::byte> packet);

 private:
  struct Impl;
  explicit OscStream(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::server
