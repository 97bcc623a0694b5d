// Asks a running daemon and waits for its answer. [one thread]
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "protocol/wire/message.h"
#include "protocol/wire/socket.h"

#include <chrono>
#include <string>
#include <utility>

namespace ringdown::cli {

class DaemonLink {
 public:
  // `url` is like osc.udp://127.0.0.1:7770. Succeeds whether or not a daemon is there: UDP cannot tell.
  static Result<DaemonLink> open(const std::string& url);

  // Sends a message of the protocol and waits for its answer. After a request that succeeds in silence, /sync is sent:
  // the answer Synced then means that the request has arrived. A refusal by the daemon is an answer (protocol::Fail);
  // an error means that no answer arrived in time.
  Result<protocol::Reply> ask(const wire::Message& message, std::chrono::milliseconds timeout);

 private:
  DaemonLink(wire::OscSocket socket, wire::Endpoint daemon, std::string url)
      : socket_(std::move(socket)), daemon_(daemon), url_(std::move(url)) {}

  wire::OscSocket socket_;
  wire::Endpoint daemon_;
  std::string url_;
};

}  // namespace ringdown::cli
