#include "protocol/schema.h"
#include "server/osc_codec.h"
#include "server/osc_packet.h"
#include "server/osc_score.h"
#include "server/osc_slip.h"
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <cmath>

namespace ringdown::fuzz {
namespace {

bool same(const protocol::Message& a, const protocol::Message& b) {
  return a.address == b.address && a.arguments.size() == b.arguments.size();
}

// A request that was accepted holds nothing but sane numbers, and written again it is accepted again.
void check_request(const protocol::Message& message) {
  const auto request = protocol::parse(message);
  if (!request) return expect(!request.error().message.empty(), "a refusal has a sentence");
  const protocol::Message again = protocol::format(*request);
  for (const protocol::Argument& argument : again.arguments) {
    const auto* number = std::get_if<double>(&argument);
    expect(!number || std::isfinite(*number), "an accepted number is finite");
  }
  const auto second = protocol::parse(again);
  expect(second && second->index() == request->index(), "a request survives being written and read");
}

}  // namespace

void osc(Bytes datagram) {
  const auto messages = server::decode_packet(datagram);
  if (!messages) return;
  for (const server::TimedMessage& timed : *messages) {
    check_request(timed.message);
    static_cast<void>(protocol::parse_reply(timed.message));
    const auto again = server::decode_packet(server::encode(timed.message));
    expect(again && again->size() == 1 && same(again->front().message, timed.message),
           "a message survives being encoded and decoded");
  }
}

void slip(Bytes stream) {
  server::SlipDecoder decoder(server::kMaxPacketBytes);
  for (const std::byte byte : stream) {
    const auto outcome = decoder.push(byte);
    if (outcome == server::SlipDecoder::Outcome::fault) break;
    if (outcome == server::SlipDecoder::Outcome::packet) osc(decoder.take());
  }
  if (stream.empty() || stream.size() > server::kMaxPacketBytes) return;
  server::SlipDecoder again(server::kMaxPacketBytes);
  for (const std::byte byte : server::slip_encode(stream)) {
    if (again.push(byte) != server::SlipDecoder::Outcome::packet) continue;
    return expect(std::ranges::equal(again.take(), stream), "a packet survives being framed");
  }
  expect(false, "a framed packet ends");
}

void score(Bytes file) {
  const auto events = server::parse_score(file, "score");
  if (!events) return;
  double last_s = 0;
  for (const server::ScoreEvent& event : *events) {
    expect(event.time_s >= last_s && event.time_s <= server::kMaxScore, "events stand by time, within a day");
    last_s = event.time_s;
    check_request(event.message);
  }
  const auto again = server::parse_score(server::encode_score(*events), "again");
  expect(again && again->size() == events->size(), "a score survives being written and read");
}

}  // namespace ringdown::fuzz
