#include "server/remote_strikes.h"

#include "protocol/schema.h"
#include "server/frame_clock.h"
#include "server/osc_codec.h"
#include "server/osc_socket.h"

#include <map>
#include <memory>

namespace ringdown::server {
namespace {

constexpr std::size_t kStrikesPerPacket = 16;  // some 1,300 bytes: one Ethernet frame

}  // namespace

Result<ScenePlayer::Sink> open_remote_strikes(const std::string& url, const Rack& rack, const Driver& driver) {
  const auto target = parse_url(url);
  if (!target) return fail(target.error());
  const auto to = resolve(target->host, target->port);
  if (!to) return fail(to.error());
  // Bound to all interfaces' any port only when the target is outside this machine.
  auto bound = OscSocket::bind({.address = to->address >> 24 == 127 ? to->address : 0, .port = 0});
  if (!bound) return fail(bound.error());
  auto socket = std::make_shared<OscSocket>(std::move(*bound));

  std::shared_ptr<FrameClock> clock;  // made with the first strikes: the driver tells no time before it runs
  return [socket, clock, to = *to, &rack, &driver](std::span<const protocol::Event> strikes) mutable {
    std::map<protocol::ObjectNumber, std::string> names;
    for (const RackObject& object : rack.objects()) names[object.number] = object.name;
    std::size_t lost = 0;
    if (!clock) clock = std::make_shared<FrameClock>(driver_clock(driver), steady_now_s);
    clock->measure();
    const double unix_ahead_s = unix_now_s() - steady_now_s();
    while (!strikes.empty()) {
      std::vector<protocol::Message> messages;
      const protocol::Frame frame = strikes.front().frame;
      while (!strikes.empty() && strikes.front().frame == frame && messages.size() < kStrikesPerPacket) {
        const protocol::Event& event = strikes.front();
        messages.push_back(protocol::format(request_for(event, {.name = names[event.object]})));
        strikes = strikes.subspan(1);
      }
      const auto packet = encode_bundle(time_tag(clock->time_of(frame) + unix_ahead_s), messages);
      if (!socket->send_to(to, packet)) lost += messages.size();
    }
    return lost;
  };
}

}  // namespace ringdown::server
