// A UDP socket for OSC. Ours instead of liblo's, which always listens on all interfaces.
//
//   auto socket = OscSocket::serve(*resolve("127.0.0.1", 7770));
//   Datagram datagram;                        // kept by the caller, so that its memory is used again
//   while (!stopping) {
//     if (socket->receive(datagram, 100ms)) handle(datagram.bytes, datagram.from);
//   }
//
// One thread receives; any thread may send and wake. [any thread but audio]
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/descriptor.h"
#include "protocol/wire/endpoint.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ringdown::wire {

struct Datagram {
  std::vector<std::byte> bytes;
  Endpoint from;
  double age_s = 0;  // how long the kernel kept it until receive() took it, by the realtime clock; never negative
};

class OscSocket {
 public:
  // Port 0 takes any free one. The address must be this computer's; 127.0.0.1, which nobody outside can reach, unless
  // the user asked for another. A taken port is an error whose sentence says so. Nothing shares the port.
  static Result<OscSocket> bind(const Endpoint& endpoint = {});

  // Binds a server's socket. Other than with bind(), 127.0.0.1 and 0.0.0.0 are served by IPv6, too (bind_for_server()
  // in endpoint.h).
  static Result<OscSocket> serve(const Endpoint& endpoint);

  // Binds the socket of a client of `server`: to the loopback if the server is there, else to any address.
  static Result<OscSocket> reach(const Endpoint& server);

  OscSocket(OscSocket&& other) noexcept;
  OscSocket& operator=(OscSocket&& other) noexcept;
  ~OscSocket();

  [[nodiscard]] Endpoint endpoint() const { return sockets_.endpoint; }
  [[nodiscard]] std::uint16_t port() const { return sockets_.endpoint.port; }

  // Bytes that the kernel queues for us while we are busy. We ask for 4 MiB; a plain user gets at most
  // net.core.rmem_max.
  [[nodiscard]] std::size_t receive_buffer_bytes() const;

  // True when a datagram came; false after the timeout or a wake(). In a flood many are fetched from the kernel at
  // once, and then given out one by one.
  bool receive(Datagram& datagram, std::chrono::milliseconds timeout);

  // Makes a receive() that waits, or the next one that asks the kernel, return false. Also from a signal handler.
  void wake() noexcept;

  Result<void> send_to(const Endpoint& to, std::span<const std::byte> bytes);

 private:
  struct Batch;

  static Result<OscSocket> open(Result<BoundSockets> sockets);
  OscSocket(BoundSockets sockets, Descriptor waker);
  bool fetch(std::chrono::milliseconds timeout);

  BoundSockets sockets_;
  Descriptor waker_;              // an eventfd
  std::unique_ptr<Batch> batch_;  // made when first something is received
};

}  // namespace ringdown::wire
