// Receives OSC packets by UDP and TCP, turns their messages into requests, and answers the senders.
//
//   OscServer server(std::move(socket), {session, worker, driver, quit});   // serves until it is destroyed
//
// The server's thread plays events itself and posts everything slow to the worker, in order. An untimed event happens
// `latency` after the kernel received its packet, so two strikes 3 ms apart stay 3 ms apart at any block size and
// however late the thread wakes. The events of a bundle happen at the bundle's time; those more than kHorizon_s ahead
// wait in the server's Schedule. Loads and scene changes happen in the worker's order. If the audio thread has
// real-time priority, the server's thread has the next lower one, in a flood for half of the time (realtime_share.h).
#pragma once

#include "protocol/reply.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"
#include "server/answers.h"
#include "server/driver.h"
#include "server/frame_clock.h"
#include "server/latency.h"
#include "server/notifier.h"
#include "server/osc_stream.h"
#include "server/realtime_share.h"
#include "server/schedule.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/sound_capture.h"
#include "server/worker.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace ringdown::server {

class OscServer {
 public:
  struct Parts {
    session::Session& session;
    Worker& worker;
    const Driver& driver;
    std::function<void()> quit;  // called on the server's thread
    Latency latency = {};
    session::Recorder* recorder = nullptr;     // null: /record is refused
    session::SoundCapture* capture = nullptr;  // null: /capture is refused
    std::shared_ptr<OscStream> stream = {};    // TCP as well
    Clocks clocks = {};
  };

  static constexpr double kHorizon_s = 0.2;

  // Starts at once.
  OscServer(wire::OscSocket socket, Parts parts);
  ~OscServer();

  [[nodiscard]] std::uint16_t port() const { return ports_->socket.port(); }

 private:
  // Arrival time of a packet, by the clock that frames are measured with and by the clock of time tags.
  struct Arrival {
    Peer from;
    double steady_s, unix_s;
    double age_s;  // time that the packet waited in the kernel or in the inbox
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
  void look_at_epoch(wire::TimeTag time, const Arrival& arrival);
  [[nodiscard]] synth::Frame frame_of(wire::TimeTag time, const Arrival& arrival) const;
  [[nodiscard]] synth::Frame horizon() const;
  [[nodiscard]] protocol::StatusReply status() const;

  // Packets that the stream's thread hands to the server's thread. The stream's thread waits while kMax are here.
  struct Inbox {
    static constexpr std::size_t kMax = 64;
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

  std::shared_ptr<AnswerPorts> ports_;  // shared with tasks of the worker that will answer
  Parts parts_;
  Notifier notifier_;
  Inbox inbox_;
  FrameClock clock_;  // used by the server thread only, like the next two members
  Schedule schedule_;
  RealtimeShare share_;
  bool told_of_epoch_ = false;  // whether time tags from 1970 were reported
  int priority_ = 0;            // the driver's last reported priority
  double looked_at_s_ = -1e9;   // when the driver was last asked for the priority
  std::jthread thread_;         // last member: ends before the others are destroyed
};

}  // namespace ringdown::server
