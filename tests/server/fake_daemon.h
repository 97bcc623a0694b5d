// A daemon of the test's own for clients to talk to: a socket that answers /sync and keeps what arrives.
#pragma once

#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/socket.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <utility>
#include <vector>

namespace ringdown::wire {

using protocol::Strike;

struct Outcome {
  int exit_code = 0;
  std::string output;  // stdout and stderr
};

inline Outcome run(const std::string& command) {
  std::FILE* const pipe = ::popen((command + " 2>&1 </dev/null").c_str(), "r");
  Outcome outcome;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) outcome.output.push_back(static_cast<char>(c));
  outcome.exit_code = WEXITSTATUS(::pclose(pipe));
  return outcome;
}

inline bool is_installed(const std::string& tool) { return run("command -v " + tool).exit_code == 0; }

// Listens until it is destroyed.
class FakeDaemon {
 public:
  // `answer` replies to each request that is no /sync; nullopt is silence.
  using Answer = std::function<std::optional<protocol::Reply>(const Message&)>;
  explicit FakeDaemon(Answer answer = [](const Message&) { return std::nullopt; })
      : answer_(std::move(answer)), thread_([this] { listen(); }) {}
  ~FakeDaemon() {
    stopping_ = true;
    socket_.wake();
    thread_.join();
  }

  [[nodiscard]] std::string port() const { return std::to_string(socket_.port()); }
  [[nodiscard]] std::string url() const { return "osc.udp://127.0.0.1:" + port(); }

  // Waits until `count` messages have arrived; ends early when they do not come.
  std::vector<TimedMessage> received(std::size_t count) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      {
        const std::lock_guard lock(mutex_);
        if (received_.size() >= count) return received_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const std::lock_guard lock(mutex_);
    return received_;
  }

 private:
  void listen() {
    Datagram datagram;
    while (!stopping_) {
      if (!socket_.receive(datagram, std::chrono::seconds(1))) continue;
      const auto messages = decode_packet(datagram.bytes);
      ASSERT_TRUE(messages) << messages.error().message;
      for (const TimedMessage& timed : *messages) handle(timed, datagram.from);
    }
  }

  void handle(const TimedMessage& timed, Endpoint from) {
    const auto request = protocol::parse(timed.message);
    if (request && request->holds<protocol::Sync>() && timed.message.arguments.size() == 1) {
      const protocol::Reply synced = protocol::Synced{request->get<protocol::Sync>().id};
      ASSERT_TRUE(socket_.send_to(from, encode(protocol::format(synced))));
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      received_.push_back(timed);
    }
    if (const auto reply = answer_(timed.message)) {
      ASSERT_TRUE(socket_.send_to(from, encode(protocol::format(*reply))));
    }
  }

  OscSocket socket_ = std::move(*OscSocket::bind());
  Answer answer_;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::vector<TimedMessage> received_;
  std::thread thread_;
};

inline Strike strike_in(const TimedMessage& timed) {
  const auto request = protocol::parse(timed.message);
  EXPECT_TRUE(request) << request.error().message;
  const auto* strike = request ? request->get_if<Strike>() : nullptr;
  EXPECT_TRUE(strike) << timed.message.address;
  return strike ? *strike : Strike{};
}

// What every client sends that is told nothing else.
inline void expect_example_blow(const TimedMessage& timed) {
  const Strike strike = strike_in(timed);
  EXPECT_EQ(strike.object.name, "bell");
  EXPECT_NEAR(length(strike.verb.point_m - Vec3{0.05, 0, 0.02}), 0, 1e-8);
  EXPECT_NEAR(length(strike.verb.impulse_ns - Vec3{-0.02, 0, 0}), 0, 1e-8);
}

}  // namespace ringdown::wire
