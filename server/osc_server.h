// The daemon's ear: receives OSC packets, turns them into requests, and answers their senders.
//
// Its thread plays events itself and leaves everything slow to the worker, in order. An untimed event happens `latency`
// after the kernel received its packet, so that two strikes 3 ms apart stay 3 ms apart whatever the block size and
// however late this thread wakes; a bundle's events happen at the bundle's time. Events further than kHorizon_s ahead
// wait in a Schedule of the server's own. Loads and scene changes happen when the worker gets to them.
#pragma once

#include "protocol/reply.h"
#include "server/driver.h"
#include "server/frame_clock.h"
#include "server/latency.h"
#include "server/osc_codec.h"
#include "server/osc_socket.h"
#include "server/schedule.h"
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
    Latency latency = {};
  };

  static constexpr double kHorizon_s = 0.2;

  // Starts at once.
  OscServer(OscSocket socket, Parts parts);
  ~OscServer();

  [[nodiscard]] std::uint16_t port() const { return socket_->port(); }

 private:
  // When a packet came: by the clock that frames are measured with, and by the one that time tags are written with.
  struct Arrival {
    Peer from;
    double steady_s, unix_s;
    double age_s;  // how long it had waited for us
  };

  void run(const std::stop_token& stop);
  void handle(const Datagram& datagram);
  void handle(const protocol::Message& message, protocol::Frame frame, Peer from);
  void expand(const protocol::Message& message, protocol::Frame frame, Peer from);
  void play(const protocol::Request& request, protocol::Frame frame, const std::string& address, Peer from);
  void play_what_is_near();
  [[nodiscard]] protocol::Frame frame_of(TimeTag time, const Arrival& arrival) const;
  [[nodiscard]] protocol::Frame horizon() const;
  void post(const protocol::Request& request, const std::string& address, Peer from);
  [[nodiscard]] protocol::StatusReply status() const;

  std::shared_ptr<OscSocket> socket_;  // shared with answers that the worker still owes
  Parts parts_;
  FrameClock clock_;  // the server thread's own, like the next
  Schedule schedule_;
  std::jthread thread_;  // last: it stops before what it uses goes away
};

}  // namespace ringdown::server
