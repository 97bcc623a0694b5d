#include "server/remote_strikes.h"

#include "server/event_sender.h"

#include <map>
#include <memory>
#include <utility>

namespace ringdown::server {

Result<session::ScenePlayer::Sink> open_remote_strikes(const std::string& url, const session::Rack& rack,
                                                       const Driver& driver, Clocks clocks) {
  auto opened = EventSender::open(url);
  if (!opened) return fail(opened);
  auto sender = std::make_shared<EventSender>(std::move(*opened));
  std::shared_ptr<FrameClock> clock;  // made with the first strikes, because the driver has no time before it runs
  return [sender, clock, clocks = std::move(clocks), &rack,
          &driver](const scene::StepReport& report) mutable -> std::size_t {
    if (report.events.empty() && report.rest_dampings.empty()) return 0;
    std::map<synth::ObjectNumber, std::string> names;
    for (const session::ObjectSnapshot& object : rack.objects()) names[object->number] = object->name;
    if (!clock) clock = std::make_shared<FrameClock>(driver_clock(driver), clocks.steady_s);
    clock->measure();
    const double unix_ahead_s = clocks.unix_s() - clocks.steady_s();
    const auto name = [&names](synth::ObjectNumber object) { return names[object]; };
    const auto time = [&](synth::Frame frame) { return clock->time_of(frame) + unix_ahead_s; };
    return sender->send(report.events, name, time) + sender->send(report.rest_dampings, name, time);
  };
}

}  // namespace ringdown::server
