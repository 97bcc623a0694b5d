// The window's connection to a daemon: a thread that sends, receives, subscribes, and notices when the daemon stops or
// starts.
//
//   DaemonClient client("osc.udp://127.0.0.1:7770", 30);
//   ... at every frame:
//   Batch batch = client.take();
//   if (batch.connection != connection) model.restart(), connection = batch.connection;
//   for (const protocol::Reply& reply : batch.replies) model.apply(reply, now_s);
//   for (protocol::Request& request : model.wants(now_s)) client.send(std::move(request));
//
// The client subscribes by /notify, and asks /status four times a second, which also keeps the subscription alive. A
// daemon that is silent for 1.5 s counts as away. A daemon that answers but sends no notices is a different process at
// the same address: the client subscribes again, with a new connection number. [one thread; no call blocks it]
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
  std::string sentence;             // for the user: the state, and what to do about it
  double seconds = 0;               // how long the state has lasted
  std::uint32_t connection = 0;     // number of the connection; 0 before the first
  std::uint64_t lost_replies = 0;   // replies lost because take() was not called in time
  std::uint64_t lost_requests = 0;  // requests lost because too many were sent at once
};

// Replies of one connection, in the order in which they came.
struct Batch {
  std::uint32_t connection = 0;  // if it differs from the last batch's, another daemon answers: restart the model
  std::vector<protocol::Reply> replies;
};

class DaemonClient {
 public:
  static constexpr std::size_t kMaxReplies = 16384;  // waiting for take(); the oldest are dropped
  static constexpr std::size_t kMaxRequests = 4096;  // waiting to be sent; further ones are dropped
  static constexpr double kAway_s = 1.5;             // time without an answer after which the daemon counts as away

  // `url` is like osc.udp://127.0.0.1:7770; a malformed one leads to a state whose sentence says so. `notice_rate_hz`
  // is clamped to 0.1 ... 200.
  DaemonClient(std::string url, double notice_rate_hz);
  ~DaemonClient();  // unsubscribes

  void send(protocol::Request request);
  [[nodiscard]] Batch take();
  [[nodiscard]] ConnectionState state() const;

  // Leaves the current daemon and connects to the one at `url`.
  void connect_to(std::string url);

 private:
  struct Connection;  // the thread, and what it shares with the caller
  std::unique_ptr<Connection> connection_;
};

}  // namespace ringdown::viewer
