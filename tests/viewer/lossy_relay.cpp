#include "tests/viewer/lossy_relay.h"

#include "protocol/schema.h"
#include "protocol/wire/codec.h"

#include <chrono>
#include <utility>

namespace ringdown::test {

using namespace std::chrono_literals;

LossyRelay::LossyRelay(std::uint16_t daemon_port, unsigned drops)
    : client_side_(*wire::OscSocket::bind()),
      daemon_side_(*wire::OscSocket::bind()),
      daemon_{.port = daemon_port},
      drops_(drops),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LossyRelay::~LossyRelay() {
  thread_.request_stop();
  thread_.join();
}

bool LossyRelay::lost() {
  if (drops_ == 0 || ++seen_ % drops_ != 0) return false;
  ++dropped_;
  return true;
}

void LossyRelay::remember(const wire::Datagram& datagram) {
  const auto messages = wire::decode_packet(datagram.bytes);
  if (!messages) return;
  for (const wire::TimedMessage& timed : *messages) {
    auto request = protocol::parse(timed.message);
    const std::scoped_lock lock(mutex_);
    if (request) asked_.push_back(std::move(*request));
  }
}

void LossyRelay::run(const std::stop_token& stop) {
  wire::Datagram datagram;
  while (!stop.stop_requested()) {
    for (int i = 0; i < 64 && client_side_.receive(datagram, i == 0 ? 2ms : 0ms); ++i) {
      client_ = datagram.from;
      remember(datagram);
      if (!lost()) static_cast<void>(daemon_side_.send_to(daemon_, datagram.bytes));
    }
    for (int i = 0; i < 64 && daemon_side_.receive(datagram, i == 0 ? 2ms : 0ms); ++i) {
      if (!lost()) static_cast<void>(client_side_.send_to(client_, datagram.bytes));
    }
  }
}

}  // namespace ringdown::test
