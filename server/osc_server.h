// The daemon's ear: receives OSC packets, turns them into requests, and answers their senders.
//
// Its thread plays events itself and leaves everything slow to the worker, in order. An untimed event happens `latency`
// after the kernel received its packet, so that two strikes 3 ms apart stay 3 ms apart whatever the block size and
// however late this thread wakes; a bundle's events happen at the bundle's time. Events further than kHorizon_s ahead
// wait in a Schedule of the server's own. Where the audio thread has real-time priority, ours has the next lower one,
// in a flood half the time (realtime_share.h). Loads and scene changes happen when the worker gets to them.
#pragma once

#include "protocol/reply.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"
#include "server/driver.h"
#include "server/frame_clock.h"
#include "server/latency.h"
#include "server/notifier.h"
#include "server/osc_stream.h"
#include "server/realtime_share.h"
#include "server/schedule.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/worker.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace ringdown::server {

// Where answers leave: by the way the request came.
struct AnswerPorts {
  wire::OscSocket socket;
  std::shared_ptr<OscStream> stream;  // null: UDP only

  void send(Peer to, std::span<const std::byte> packet);
};

class OscServer {
 public:
  struct Parts {
    session::Session& session;
    Worker& worker;
    const Driver& driver;
    std::function<void()> quit;  // called on the server's thread
    Latency latency = {};
    session::Recorder* recorder = nullptr;   // null: /record is refused
    std::shared_ptr<OscStream> stream = {};  // TCP as well
    Clocks clocks = {};
  };

  static constexpr double kHorizon_s = 0.2;

  // Starts at once.
  OscServer(wire::OscSocket socket, Parts parts);
  ~OscServer();

  [[nodiscard]] std::uint16_t port() const { return ports_->socket.port(); }

 private:
  // When a packet came: by the clock that frames are measured with, and by the one that time tags are written with.
  struct Arrival {
    Peer from;
    double steady_s, unix_s;
    double age_s;  // how long it had waited for us
  };

  void run(const std::stop_token& stop);
  void adopt_priority();
  void handle(std::span<const std::byte> packet, Peer from, double age_s);
  void take_from_stream(std::span<const std::byte> packet, Peer from);
  void handle_inbox();
  void handle(const wire::Message& message, synth::Frame frame, Peer from);
  void expand(const wire::Message& message, synth::Frame frame, Peer from);
  void take(Schedule::Request request, synth::Frame frame, const std::string& address, Peer from);
  Result<void> schedule(Schedule::Request request, synth::Frame frame, const std::string& address, Peer from);
  void carry_out(const Schedule::Request& request, synth::Frame frame, const std::string& address, Peer from);
  void carry_out_what_is_near();
  template <class Lane>
  void perform(const Lane& request, synth::Frame frame, const std::string& address, Peer from);
  void write(const protocol::FileRequest& request, const std::string& address, Peer from);
  void ask(const protocol::Question& question, const std::string& address, Peer from);
  void subscribe(const protocol::SubscriptionRequest& request, const std::string& address, Peer from);
  void answer_at_once(const protocol::DaemonRequest& request, const std::string& address, Peer from);
  void post(Worker::Task task, const std::string& address, Peer from);
  [[nodiscard]] synth::Frame frame_of(wire::TimeTag time, const Arrival& arrival) const;
  [[nodiscard]] synth::Frame horizon() const;
  [[nodiscard]] protocol::StatusReply status() const;

  // What the stream's thread hands to ours. It waits while kMost packets are here.
  struct Inbox {
    static constexpr std::size_t kMost = 64;
    struct Packet {
      std::vector<std::byte> bytes;
      Peer from;
      double steady_s;
    };
    std::mutex mutex;
    std::condition_variable room;
    std::vector<Packet> packets;
    bool closed = false;
  };

  std::shared_ptr<AnswerPorts> ports_;  // shared with answers that the worker still owes
  Parts parts_;
  Notifier notifier_;
  Inbox inbox_;
  FrameClock clock_;  // the server thread's own, like the next
  Schedule schedule_;
  RealtimeShare share_;
  int priority_ = 0;           // as the driver reported it last
  double looked_at_s_ = -1e9;  // when it did
  std::jthread thread_;        // last: it stops before what it uses goes away
};

}  // namespace ringdown::server
