// Real daemons for tests: a private jackd with its dummy driver, ringdownd on a free port, and a client that talks to
// it.
#pragma once

#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"
#include "tests/integration/process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace ringdown::test {

// The JACK server of the tests: one runs at a time, and a test that wants it waits until the test before, and whatever
// that one left running, has ended. Two reasons:
// - libjack names a client's socket by user and client (/dev/shm/jack_ringdown_0_0), not by server: clients of the same
//   name at two servers take each other's socket away, and one is told what happens at the other's server.
// - JACK's list of servers has eight places on a machine, and a server that was killed holds its place until one of the
//   same name starts.
class JackServer {
 public:
  // patient: no cycle begins before every client has finished the one before, so no block is ever lost, however busy
  // the machine. realtime: as musicians run it, with real-time scheduling; a client that is late loses its block.
  enum class Mode { patient, realtime };

  explicit JackServer(int sample_rate_hz = 48000, int period_frames = 256, Mode mode = Mode::patient);
  JackServer(const JackServer&) = delete;
  JackServer& operator=(const JackServer&) = delete;
  ~JackServer();
  void stop(int signal = SIGTERM);  // and waits for its end
  void send_signal(int signal) const { server_->send_signal(signal); }
  void start(int sample_rate_hz, int period_frames);

  [[nodiscard]] static std::string name() { return "ringdown-test"; }
  [[nodiscard]] Process::Environment environment() const;  // makes clients use it, and never start another
  [[nodiscard]] testing::AssertionResult runs();           // waits for it; a failure says what jackd said

  // Ports and what they are connected to, as jack_lsp -c says.
  [[nodiscard]] std::map<std::string, std::set<std::string>> connections() const;

 private:
  int lock_;  // the server holds it too
  Mode mode_;
  std::unique_ptr<Process> server_;
};

class Daemon {
 public:
  // `arguments` after `ringdownd --port 0`; with --budget 0 unless they say otherwise.
  explicit Daemon(std::vector<std::string> arguments, const Process::Environment& environment = {});

  [[nodiscard]] bool ready() const { return port_ != 0; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] Process& process() { return process_; }

  void send(const wire::Message& message);
  void send_bundle(double unix_s, const std::vector<wire::Message>& messages);

  // What the next packet holds: nothing after `limit`.
  std::vector<protocol::Reply> packet(std::chrono::milliseconds limit = kPatience);
  // Its first reply.
  std::optional<protocol::Reply> reply(std::chrono::milliseconds limit = kPatience);
  // Sends and waits for a reply.
  std::optional<protocol::Reply> ask(const wire::Message& message);

 private:
  Process process_;
  std::uint16_t port_ = 0;
  wire::OscSocket socket_;
};

// Sends and waits for the first reply of this kind; notices may come before it. A refusal is nothing.
template <class Struct>
std::optional<Struct> ask_for(Daemon& daemon, const wire::Message& message) {
  daemon.send(message);
  for (;;) {
    const auto replies = daemon.packet();
    if (replies.empty()) return std::nullopt;
    for (const protocol::Reply& reply : replies) {
      if (const auto* wanted = reply.get_if<Struct>()) return *wanted;
      if (reply.holds<protocol::Fail>()) return std::nullopt;
    }
  }
}
inline bool done(Daemon& daemon, const wire::Message& message) {
  return ask_for<protocol::Done>(daemon, message).has_value();
}

// Asks again until `holds()`, at most this long.
template <class Condition>
bool becomes_true(Condition holds, std::chrono::milliseconds limit = kPatience) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

inline std::string program(const std::string& name) { return std::string(RINGDOWN_BIN_DIR) + "/" + name; }

}  // namespace ringdown::test
