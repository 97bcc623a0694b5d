// OSC over TCP, framed by SLIP as OSC 1.1 has it: for clients that must lose nothing, or sit behind something that
// passes no UDP. By option; on this computer only unless the user says otherwise.
//
// Its own thread accepts, reads and writes. A client that sends no SLIP, a packet that begins with neither / nor # (a
// browser, whose page wants to play), more than kMaxPacketBytes in a packet, or does not read its answers, is cut off;
// so is the one after kMaxConnections.
#pragma once

#include "engine/base/result.h"
#include "server/osc_ports.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace ringdown::server {

inline constexpr std::size_t kMaxConnections = 16;
inline constexpr std::size_t kMaxUnread = std::size_t{1} << 20;  // bytes of answers that wait for one client

class OscStream {
 public:
  // Port 0 takes any free one.
  static Result<std::unique_ptr<OscStream>> listen(wire::Endpoint endpoint);
  ~OscStream();

  [[nodiscard]] std::uint16_t port() const;

  // Begins to serve. `take` gets each packet, on the stream's thread; while it waits, nothing more is read. Once.
  using Take = std::function<void(std::span<const std::byte> packet, Peer from)>;
  void start(Take take);
  void stop();  // takes no more, and returns when the last `take` has

  // Nothing happens when the peer has gone. [any thread]
  void send(Peer to, std::span<const std::byte> packet);

 private:
  struct Impl;
  explicit OscStream(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ringdown::server
