#include "server/event_sender.h"

#include "protocol/request.h"
#include "protocol/schema.h"
#include "protocol/wire/codec.h"

#include <utility>
#include <vector>

namespace ringdown::server {
namespace {

constexpr std::size_t kEventsPerPacket = 16;  // some 1,300 bytes: one Ethernet frame

}  // namespace

Result<EventSender> EventSender::open(const std::string& url) {
  const auto target = wire::parse_url(url);
  if (!target) return fail(target);
  const auto to = wire::resolve(target->host, target->port);
  if (!to) return fail(to);
  auto bound = wire::OscSocket::reach(*to);
  if (!bound) return fail(bound);
  return EventSender(std::move(*bound), *to);
}

std::size_t EventSender::send(std::span<const synth::Event> events, const NameOf& name, const UnixTimeOf& unix_time) {
  std::size_t lost = 0;
  while (!events.empty()) {
    std::vector<wire::Message> messages;
    const synth::Frame frame = events.front().frame;
    while (!events.empty() && events.front().frame == frame && messages.size() < kEventsPerPacket) {
      const synth::Event& event = events.front();
      messages.push_back(protocol::format(protocol::request_for(event, {.name = name(event.object)})));
      events = events.subspan(1);
    }
    const auto packet = wire::encode_bundle(wire::time_tag(unix_time(frame)), messages);
    if (!socket_.send_to(to_, packet)) lost += messages.size();
  }
  return lost;
}

std::size_t EventSender::send(std::span<const scene::RestDamping> dampings, const NameOf& name,
                              const UnixTimeOf& unix_time) {
  std::size_t lost = 0;
  for (const scene::RestDamping& damping : dampings) {
    std::vector<wire::Message> messages;
    for (const protocol::Hold& damper : protocol::dampers_for(damping.dampers, {.name = name(damping.object)})) {
      messages.push_back(protocol::format(damper));
    }
    lost += !socket_.send_to(to_, wire::encode_bundle(wire::time_tag(unix_time(damping.frame)), messages));
  }
  return lost;
}

}  // namespace ringdown::server
