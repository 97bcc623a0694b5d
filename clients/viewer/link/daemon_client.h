// The window's line to a daemon: a thread that sends, receives, subscribes and notices when the daemon goes and comes.
//
//   DaemonClient client("osc.udp://127.0.0.1:7770", 30);
//   ... at every frame:
//   Batch batch = client.take();
//   if (batch.connection != connection) model.restart(), connection = batch.connection;
//   for (const protocol::Reply& reply : batch.replies) model.apply(reply, now_s);
//   for (protocol::Request& request : model.wants(now_s)) client.send(std::move(request));
//
// It subscribes by /notify by itself, and asks /status four times a second, which also keeps the subscription alive. A
// daemon that is silent for 1.5 s is away. One that answers but tells nothing has forgotten us, for it is another one:
// then it is subscribed to anew, with a new connection number. [one thread; nothing here blocks it]
#pragma once

#include "protocol/reply.h"
#include "protocol/request.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::viewer {

struct ConnectionState {
  enum class Kind { connecting, connected, away };
  Kind kind = Kind::connecting;
  std::string sentence;             // for the user: what is, and what to do
  double seconds = 0;               // since it is so
  std::uint32_t connection = 0;     // 0 before the first; grows with each
  std::uint64_t lost_replies = 0;   // because take() was not called in time
  std::uint64_t lost_requests = 0;  // because too many were sent at a time
};

// Replies of one connection, in the order in which they came.
struct Batch {
  std::uint32_t connection = 0;  // differs from the last batch's: forget what you know of the daemon
  std::vector<protocol::Reply> replies;
};

class DaemonClient {
 public:
  static constexpr std::size_t kMaxReplies = 16384;  // that wait for take(); the oldest go
  static constexpr std::size_t kMaxRequests = 4096;  // that wait to be sent; further ones are dropped
  static constexpr double kAway_s = 1.5;             // without an answer

  // `url` as in osc.udp://127.0.0.1:7770; a wrong one is a state with its sentence. `notice_rate_hz` from 0.1 to 200.
  DaemonClient(std::string url, double notice_rate_hz);
  ~DaemonClient();  // unsubscribes

  void send(protocol::Request request);
  [[nodiscard]] Batch take();
  [[nodiscard]] ConnectionState state() const;

  // Leaves the daemon, and looks for the one there.
  void connect_to(std::string url);

 private:
  struct Line;  // what the thread owns, and what it shares
  std::unique_ptr<Line> line_;
};

}  // namespace ringdown::viewer
