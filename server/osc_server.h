// The daemon's ear: receives OSC packets, turns them into requests, and answers their senders.
//
// Its thread plays events itself and leaves everything slow to the worker, in order. An untimed event happens `latency`
// after its packet arrived, so that two strikes 3 ms apart stay 3 ms apart whatever the block size; a bundle's events
// happen at the bundle's time. Loads and scene changes happen when the worker gets to them.
#pragma once

#include "protocol/reply.h"
#include "server/driver.h"
#include "server/osc_codec.h"
#include "server/osc_socket.h"
#include "server/session.h"
#include "server/worker.h"

#include <functional>
#include <memory>
#include <thread>

namespace ringdown::server {

class OscServer {
 public:
  struct Parts {
    Session& session;
    Worker& worker;
    const Driver& driver;
    std::function<void()> quit;  // called on the server's thread
  };

  // Starts at once.
  OscServer(OscSocket socket, Parts parts);
  ~OscServer();

  [[nodiscard]] std::uint16_t port() const { return socket_->port(); }

 private:
  // When a datagram came, by both clocks: what its time tags are measured from.
  struct Arrival {
    Endpoint from;
    protocol::Frame frame;
    double unix_s;
  };

  void run(const std::stop_token& stop);
  void handle(const Datagram& datagram);
  void handle(const TimedMessage& timed, const Arrival& arrival);
  [[nodiscard]] protocol::Frame frame_of(TimeTag time, const Arrival& arrival) const;
  void post(const protocol::Request& request, const std::string& address, Endpoint from);
  [[nodiscard]] protocol::StatusReply status() const;

  std::shared_ptr<OscSocket> socket_;  // shared with answers that the worker still owes
  Parts parts_;
  std::jthread thread_;
};

// How long after its arrival an untimed event happens: one block, so that its frame is still to come, and a
// sixteenth of one for the clock's jitter.
inline protocol::Frame latency_frames(const Driver& driver) {
  const auto block = static_cast<protocol::Frame>(driver.block_frames());
  return block + block / 16;
}

}  // namespace ringdown::server
