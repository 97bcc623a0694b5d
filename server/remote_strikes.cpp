#include "server/remote_strikes.h"

#include "server/event_sender.h"
#include "server/frame_clock.h"

#include <map>
#include <memory>

namespace ringdown::server {

Result<ScenePlayer::Sink> open_remote_strikes(const std::string& url, const Rack& rack, const Driver& driver) {
  auto opened = EventSender::open(url);
  if (!opened) return fail(opened.error());
  auto sender = std::make_shared<EventSender>(std::move(*opened));
  std::shared_ptr<FrameClock> clock;  // made with the first strikes: the driver tells no time before it runs
  return [sender, clock, &rack, &driver](std::span<const protocol::Event> strikes) mutable {
    std::map<protocol::ObjectNumber, std::string> names;
    for (const RackObject& object : rack.objects()) names[object.number] = object.name;
    if (!clock) clock = std::make_shared<FrameClock>(driver_clock(driver), steady_now_s);
    clock->measure();
    const double unix_ahead_s = unix_now_s() - steady_now_s();
    return sender->send(
        strikes, [&names](protocol::ObjectNumber object) { return names[object]; },
        [&](protocol::Frame frame) { return clock->time_of(frame) + unix_ahead_s; });
  };
}

}  // namespace ringdown::server
