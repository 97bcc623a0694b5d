// The OSC server inside the test's process, with a clock that the test sets and a driver that renders only when told,
// so that what was sent can be looked for in the samples to the frame, however busy the machine.
#pragma once

#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "protocol/wire/score.h"
#include "server/osc_server.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <unistd.h>
#include <utility>
#include <vector>

namespace ringdown::server {

using namespace std::chrono_literals;
using synth::Frame;
using wire::Message;

inline constexpr double kRate = 48000;
inline constexpr std::size_t kBlock = 256;

// Time that passes when the test says so. The audio clock started with the steady one.
class FakeTime {
 public:
  static constexpr double kUnixAhead_s = 1.7e9;  // of the steady clock: in 2023

  void pass(double seconds) { now_s_ = now_s_ + seconds; }
  [[nodiscard]] double steady_s() const { return ++reads_, now_s_.load(); }
  [[nodiscard]] double unix_s() const { return kUnixAhead_s + now_s_; }
  [[nodiscard]] double frame_of(double unix_s) const { return (unix_s - kUnixAhead_s) * kRate; }
  [[nodiscard]] Frame frame() const { return static_cast<Frame>(now_s_ * kRate); }
  [[nodiscard]] int reads() const { return reads_; }  // of the steady clock

  [[nodiscard]] Clocks clocks() const {
    return {[this] { return steady_s(); }, [this] { return unix_s(); }};
  }

 private:
  std::atomic<double> now_s_ = 0.123456;
  mutable std::atomic<int> reads_ = 0;
};

class StillDriver final : public Driver {
 public:
  [[nodiscard]] double sample_rate_hz() const override { return kRate; }
  [[nodiscard]] std::size_t block_frames() const override { return kBlock; }
  Result<void> start(Program) override { return {}; }
  [[nodiscard]] Frame now() const override { return time_.frame(); }
  [[nodiscard]] Load load() const override { return {}; }
  // The OSC server's thread asks every second of its clock, and waits here while the test holds it.
  [[nodiscard]] int control_priority() const override {
    waits_ = held_.load();
    waits_.notify_all();
    held_.wait(true);
    return 0;
  }

  explicit StillDriver(const FakeTime& time) : time_(time) {}

  // Keeps the server's thread from working once it asks for its priority.
  void hold_server(bool on) {
    held_ = on;
    held_.notify_all();
  }
  void wait_until_held() const { waits_.wait(false); }

 private:
  const FakeTime& time_;
  std::atomic<bool> held_ = false;
  mutable std::atomic<bool> waits_ = false;
};

// The messages of one bundle that comes to `socket`.
inline std::vector<protocol::Reply> notice(wire::OscSocket& socket) {
  wire::Datagram datagram;
  std::vector<protocol::Reply> replies;
  if (!socket.receive(datagram, 60s)) return replies;
  const auto messages = wire::decode_packet(datagram.bytes);
  EXPECT_TRUE(messages);
  for (const wire::TimedMessage& timed : *messages) {
    const auto reply = protocol::parse_reply(timed.message);
    EXPECT_TRUE(reply) << reply.error().message;
    if (reply) replies.push_back(*reply);
  }
  return replies;
}

// Reads notices until one holds a message that `wanted` likes.
template <class Struct>
std::optional<Struct> wait_for(wire::OscSocket& socket, const std::function<bool(const Struct&)>& wanted) {
  for (int i = 0; i < 1000; ++i) {
    const auto replies = notice(socket);
    if (replies.empty()) return std::nullopt;
    for (const protocol::Reply& reply : replies) {
      const auto* found = reply.get_if<Struct>();
      if (found && wanted(*found)) return *found;
    }
  }
  return std::nullopt;
}

class OscServerTest : public testing::Test {
 protected:
  OscServerTest() {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(6000, 800), folder_ / "tick.glb"));  // silent after 20 ms
  }
  ~OscServerTest() override {
    driver_.hold_server(false);
    server_.reset();
  }

  void serve(Latency latency = {}, std::shared_ptr<OscStream> stream = {}) {
    auto socket = wire::OscSocket::serve({});
    ASSERT_TRUE(socket) << socket.error().message;
    server_.emplace(std::move(*socket), OscServer::Parts{session_, worker_, driver_, [] {}, latency, &recorder_,
                                                         &capture_, std::move(stream), time_.clocks()});
    to_ = {.port = server_->port()};
  }

  void load(const std::string& name) { ASSERT_TRUE(session_.rack().load(name, folder_ / "tick.glb")); }

  void send(const Message& message) { ASSERT_TRUE(client_.send_to(to_, wire::encode(message))); }
  void send_at(double unix_s, const Message& message) {
    ASSERT_TRUE(client_.send_to(to_, wire::encode_bundle(wire::time_tag(unix_s), std::span(&message, 1))));
  }

  std::optional<protocol::Reply> reply() {
    wire::Datagram datagram;
    if (!client_.receive(datagram, 60s)) return std::nullopt;
    const auto messages = wire::decode_packet(datagram.bytes);
    const auto parsed = messages ? protocol::parse_reply(messages->front().message) : fail(messages.error());
    return parsed ? std::optional(*parsed) : std::nullopt;
  }
  // Sends, and returns the sentence of the /fail that must come.
  std::string refusal(const Message& message) {
    send(message);
    const auto answer = reply();
    const auto* refused = answer ? answer->get_if<protocol::Fail>() : nullptr;
    return refused ? refused->sentence : "";
  }
  // Returns when all that was sent has been taken up.
  void sync() {
    send({"/sync", {++syncs_}});
    for (;;) {
      const auto answer = reply();
      ASSERT_TRUE(answer);
      const auto* synced = answer->get_if<protocol::Synced>();
      if (synced && synced->id == syncs_) return;
    }
  }

  // Whether all that was sent has been taken up without a word.
  bool is_silent() {
    send({"/sync", {++syncs_}});
    const auto answer = reply();
    return answer && answer->holds<protocol::Synced>();
  }

  // Lets time pass until `unix_s`; the schedule has then given to the mixer what should sound until then.
  void pass_until(double unix_s) {
    sync();
    time_.pass(unix_s - time_.unix_s());
    sync();  // answered before or after the server looks at its schedule,
    sync();  // and this one after it
  }

  // Renders what has been sent until now, and a tenth of a second more.
  std::vector<Frame> onsets_until_now() { return onsets_until(time_.frame() + 4800); }

  // Renders to `end`, in blocks, and notes where sound rises out of silence.
  std::vector<Frame> onsets_until(Frame end) {
    std::vector<Frame> found;
    for (Frame at = session_.rack().mixer().counters().frames; at < end; at += static_cast<Frame>(kBlock)) {
      std::vector<float> left(kBlock), right(kBlock);
      session_.rack().mixer().render(left, right);
      for (std::size_t n = 0; n < kBlock; ++n) {
        if (std::abs(left[n]) < 1e-5) continue;
        const Frame frame = at + static_cast<Frame>(n);
        if (found.empty() || frame - last_loud_ > 480) found.push_back(frame);
        last_loud_ = frame;
      }
    }
    return found;
  }

  static Message strike(const std::string& object) {
    return protocol::format(protocol::Strike{{.name = object}, {{1, 0, 0}, {0, 0, 1}, 0}});
  }

  test::TemporaryFolder folder_;
  FakeTime time_;
  StillDriver driver_{time_};
  session::Session session_{kRate};
  session::Recorder recorder_{session_.rack(), wire::write_score};
  session::SoundCapture capture_{session_.rack()};
  Worker worker_{[] {}, 10ms};
  wire::OscSocket client_ = std::move(*wire::OscSocket::bind());
  wire::Endpoint to_;
  std::optional<OscServer> server_;
  std::int32_t syncs_ = 0;
  Frame last_loud_ = -100000;
};

}  // namespace ringdown::server
