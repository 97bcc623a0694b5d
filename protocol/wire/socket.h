// A UDP socket for OSC. liblo's server is not used, because it always listens on all interfaces.
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
  double age_s = 0;  // time from arrival in the kernel to receive(), by the realtime clock; never negative
};

class OscSocket {
 public:
  // Binds a socket to an address of this computer; port 0 means any free port. Use 127.0.0.1, which only this computer
  // can reach, unless the user asked for another address. A port in use is an error whose sentence says so. The port is
  // not shared.
  static Result<OscSocket> bind(const Endpoint& endpoint = {});

  // Binds a server's socket. Unlike bind(), also serves IPv6 for 127.0.0.1 and 0.0.0.0 (bind_for_server() in
  // endpoint.h).
  static Result<OscSocket> serve(const Endpoint& endpoint);

  // Binds the socket of a client of `server`: to the loopback address if the server has one, else to any address.
  static Result<OscSocket> reach(const Endpoint& server);

  OscSocket(OscSocket&& other) noexcept;
  OscSocket& operator=(OscSocket&& other) noexcept;
  ~OscSocket();

  [[nodiscard]] Endpoint endpoint() const { return sockets_.endpoint; }
  [[nodiscard]] std::uint16_t port() const { return sockets_.endpoint.port; }

  // The number of bytes that the kernel queues while this thread is busy. We request 4 MiB; users without privileges
  // get at most net.core.rmem_max.
  [[nodiscard]] std::size_t receive_buffer_bytes() const;

  // Waits for a datagram; returns false after the timeout or a wake(). In a flood many datagrams are fetched from the
  // kernel at once and then returned one by one.
  bool receive(Datagram& datagram, std::chrono::milliseconds timeout);

  // Makes a waiting receive(), or the next one that asks the kernel, return false. May be called in a signal handler.
  void wake() noexcept;

  Result<void> send_to(const Endpoint& to, std::span<const std::byte> bytes);

 private:
  struct Batch;

  static Result<OscSocket> open(Result<BoundSockets> sockets);
  OscSocket(BoundSockets sockets, Descriptor waker);
  bool fetch(std::chrono::milliseconds timeout);

  BoundSockets sockets_;
  Descriptor waker_;              // an eventfd
  std::unique_ptr<Batch> batch_;  // made at the first receive()
};

}  // namespace ringdown::wire
