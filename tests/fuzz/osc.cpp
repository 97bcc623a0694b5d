#include "protocol/schema.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/framing.h"
#include "protocol/wire/packet.h"
#include "protocol/wire/score.h"
#include "server/nsm_messages.h"
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <cmath>

namespace ringdown::fuzz {
namespace {

bool same(const wire::Message& a, const wire::Message& b) {
  return a.address == b.address && a.arguments.size() == b.arguments.size();
}

// A request that was accepted holds nothing but sane numbers, and written again it is accepted again.
void check_request(const wire::Message& message) {
  const auto request = protocol::parse(message);
  if (!request) return expect(!request.error().message.empty(), "a refusal has a sentence");
  const wire::Message again = protocol::format(*request);
  for (const wire::Argument& argument : again.arguments) {
    const auto* number = std::get_if<double>(&argument);
    expect(!number || std::isfinite(*number), "an accepted number is finite");
  }
  const auto second = protocol::parse(again);
  expect(second && second->index() == request->index(), "a request survives being written and read");
}

}  // namespace

void osc(Bytes datagram) {
  const auto messages = wire::decode_packet(datagram);
  if (!messages) return;
  for (const wire::TimedMessage& timed : *messages) {
    check_request(timed.message);
    static_cast<void>(protocol::parse_reply(timed.message));
    const auto again = wire::decode_packet(wire::encode(timed.message));
    expect(again && again->size() == 1 && same(again->front().message, timed.message),
           "a message survives being encoded and decoded");
  }
}

void stream(Bytes bytes) {
  wire::FrameDecoder decoder(wire::kMaxPacketBytes);
  for (const std::byte byte : bytes) {
    const auto outcome = decoder.push(byte);
    if (outcome == wire::FrameDecoder::Outcome::fault) break;
    if (outcome == wire::FrameDecoder::Outcome::packet) osc(decoder.take());
  }
  if (bytes.empty() || bytes.size() > wire::kMaxPacketBytes) return;
  for (const wire::Framing framing : {wire::Framing::slip, wire::Framing::length}) {
    wire::FrameDecoder again(wire::kMaxPacketBytes);
    const std::vector<std::byte> framed = wire::frame(bytes, framing);
    std::size_t read = 0;
    while (read < framed.size() && again.push(framed[read++]) != wire::FrameDecoder::Outcome::packet) continue;
    expect(read == framed.size() && std::ranges::equal(again.take(), bytes), "a packet survives being framed");
  }
}

void score(Bytes file) {
  const auto events = wire::parse_score(file, "score");
  if (!events) return;
  double last_s = 0;
  for (const wire::ScoreEvent& event : *events) {
    expect(event.time_s >= last_s && event.time_s <= wire::kMaxScore, "events stand by time, within a day");
    last_s = event.time_s;
    check_request(event.message);
  }
  const auto again = wire::parse_score(wire::encode_score(*events), "again");
  expect(again && again->size() == events->size(), "a score survives being written and read");
}

void nsm(Bytes datagram) {
  const auto request = server::parse_nsm(datagram);
  if (!request || request->kind == server::NsmRequest::Kind::save) return;
  if (!request->session) return expect(!request->session.error().message.empty(), "a refusal has a sentence");
  expect(request->kind == server::NsmRequest::Kind::open, "only an opened session has a place");
  expect(request->session->path.is_absolute() && !request->session->client_id.empty(),
         "a session has a place and a name");
}

}  // namespace ringdown::fuzz
