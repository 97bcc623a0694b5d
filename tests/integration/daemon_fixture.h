// Real daemons for tests: a private jackd with its dummy driver, ringdownd on a free port, and a client that talks to
// it.
#pragma once

#include "protocol/schema.h"
#include "server/osc_codec.h"
#include "server/osc_socket.h"
#include "tests/integration/process.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::test {

// A JACK server of the test's own, named after this process.
class JackServer {
 public:
  JackServer();
  [[nodiscard]] Process::Environment environment() const;  // makes clients use it, and never start another
  [[nodiscard]] bool runs();
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  Process server_;
};

class Daemon {
 public:
  // `arguments` after `ringdownd --port 0`.
  explicit Daemon(std::vector<std::string> arguments, const Process::Environment& environment = {});

  [[nodiscard]] bool ready() const { return port_ != 0; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] Process& process() { return process_; }

  void send(const protocol::Message& message);
  void send_bundle(double unix_s, const std::vector<protocol::Message>& messages);

  // The next reply, or nothing after `limit`.
  std::optional<protocol::Reply> reply(std::chrono::milliseconds limit = std::chrono::seconds(5));
  // Sends and waits for a reply.
  std::optional<protocol::Reply> ask(const protocol::Message& message);

 private:
  Process process_;
  std::uint16_t port_ = 0;
  server::OscSocket socket_;
};

inline std::string program(const std::string& name) { return std::string(RINGDOWN_BIN_DIR) + "/" + name; }

}  // namespace ringdown::test
