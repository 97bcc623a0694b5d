#include "server/session/request_events.h"

#include "protocol/bulk.h"

#include <cmath>
#include <string>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::EventType;

// No sentence of this file names an argument or an address, because OSC, the C library and Python have names of their
// own for both.
tl::unexpected<Error> no_such(const char* what, std::size_t number, std::size_t count, const ObjectState& object) {
  return fail(ErrorKind::bad_input, "there is no " + std::string(what) + " " + std::to_string(number) + ": \"" +
                                        object.name + "\" has " + std::to_string(count) +
                                        ", which are numbered from 0");
}

// Single precision on the way may leave a unit quaternion a little longer or shorter.
Result<void> check_turn(const Rotation& turn) {
  if (std::abs(norm(turn) - 1) <= 0.01) return {};
  return fail(ErrorKind::bad_input, "the rotation w x y z must be a quaternion of length 1; 1 0 0 0 is not turned");
}

struct AppendEvents {
  const Rack& rack;
  synth::Frame frame;
  std::vector<Event>& events;

  Result<void> operator()(const protocol::Strike& strike) const {
    const auto object = rack.find(strike.object);
    if (!object) return fail(object.error());
    if (auto good = check_point(strike.point_m, **object); !good) return good;
    return append(**object, {.type = EventType::strike,
                             .point_m = strike.point_m,
                             .impulse_ns = strike.impulse_ns,
                             .contact_time_s = strike.contact_time_s});
  }

  Result<void> operator()(const protocol::StrikeVertex& strike) const {
    const auto object = rack.find(strike.object);
    if (!object) return fail(object.error());
    const std::size_t points = (*object)->map->bank().point_count();
    if (strike.vertex >= points) return no_such("sample point", strike.vertex, points, **object);
    return append(**object, {.type = EventType::strike_vertex,
                             .vertex = strike.vertex,
                             .impulse_ns = strike.impulse_ns,
                             .contact_time_s = strike.contact_time_s});
  }

  Result<void> operator()(const protocol::StrikeMany& bulk) const {
    const auto strikes = protocol::decode_strikes(bulk.records);
    if (!strikes) return fail(strikes.error());
    for (std::size_t i = 0; i < strikes->size(); ++i) {
      const protocol::BulkStrike& one = (*strikes)[i];
      const protocol::ObjectRef object{.number = one.object};
      const auto delay = static_cast<synth::Frame>(std::llround(one.delay_s * rack.mixer().sample_rate_hz()));
      const AppendEvents later{rack, frame + delay, events};
      const auto done = one.vertex
                            ? later(protocol::StrikeVertex{object, *one.vertex, one.impulse_ns, one.contact_time_s})
                            : later(protocol::Strike{object, one.point_m, one.impulse_ns, one.contact_time_s});
      if (!done) return fail(done.error().kind, "record " + std::to_string(i + 1) + ": " + done.error().message);
    }
    return {};
  }

  Result<void> operator()(const protocol::SetGain& set) const {
    return append(set.object, {.type = EventType::gain, .value = set.gain, .ramp_s = set.ramp_s});
  }

  Result<void> operator()(const protocol::SetPan& set) const {
    return append(set.object, {.type = EventType::pan, .value = set.pan});
  }

  Result<void> operator()(const protocol::RingModes& ring) const {
    const auto object = rack.find(ring.object);
    if (!object) return fail(object.error());
    const std::size_t modes = (*object)->map->bank().mode_count();
    if (ring.first >= modes) return no_such("mode", ring.first, modes, **object);
    return append(**object,
                  {.type = EventType::ring, .vertex = ring.first, .count = ring.count, .value = ring.amplitude});
  }

  Result<void> operator()(const protocol::ClearObject& clear) const {
    return append(clear.object, {.type = EventType::clear, .ramp_s = clear.ramp_s});
  }

  Result<void> operator()(const protocol::SetContact& set) const {
    const auto object = rack.find(set.object);
    if (!object) return fail(object.error());
    if (auto good = check_point(set.point_m, **object); !good) return good;
    return append(**object, {.type = EventType::contact, .point_m = set.point_m, .contact = set.contact});
  }

  Result<void> operator()(const protocol::SetBow& set) const {
    return append_touch(set.object, set.point_m, set.touch, set.touch.direction, "direction");
  }

  Result<void> operator()(const protocol::HitMallet& hit) const {
    synth::Touch touch = hit.touch;
    touch.speed_m_s = length(hit.velocity_m_s);
    return append_touch(hit.object, hit.point_m, touch, hit.velocity_m_s, "velocity");
  }

  Result<void> operator()(const protocol::SetCoupling& set) const {
    const auto other = rack.find(set.other);
    if (!other) return fail(other.error());
    if (auto good = check_point(set.touch.other_point_m, **other); !good) return good;
    synth::Touch touch = set.touch;
    touch.other = (*other)->number;
    const auto object = rack.find(set.object);
    if (object && (*object)->number == touch.other) {
      return fail(ErrorKind::bad_input, "an object does not touch itself; name another one");
    }
    return append_touch(set.object, set.point_m, touch, set.touch.direction, "direction");
  }

  Result<void> operator()(const protocol::Click& click) const {
    return append(click.object,
                  {.type = EventType::click, .impulse_ns = click.impulse_ns, .contact_time_s = click.contact_time_s});
  }

  Result<void> operator()(const protocol::SetPose& set) const {
    const auto object = rack.find(set.object);
    if (!object) return fail(object.error());
    if (auto good = check_turn(set.pose.rotation); !good) return good;
    return append(**object,
                  {.type = EventType::pose, .point_m = set.pose.position_m, .rotation = normalized(set.pose.rotation)});
  }

  Result<void> operator()(const protocol::PoseMany& bulk) const {
    const auto poses = protocol::decode_poses(bulk.records);
    if (!poses) return fail(poses.error());
    for (std::size_t i = 0; i < poses->size(); ++i) {
      const protocol::BulkPose& one = (*poses)[i];
      const auto delay = static_cast<synth::Frame>(std::llround(one.delay_s * rack.mixer().sample_rate_hz()));
      const AppendEvents later{rack, frame + delay, events};
      const auto done = later(protocol::SetPose{{.number = one.object}, one.pose});
      if (!done) return fail(done.error().kind, "record " + std::to_string(i + 1) + ": " + done.error().message);
    }
    return {};
  }

  Result<void> operator()(const protocol::SetListener& set) const {
    if (auto good = check_turn(set.pose.rotation); !good) return good;
    return append_for_all(
        {.type = EventType::listener, .point_m = set.pose.position_m, .rotation = normalized(set.pose.rotation)});
  }

  Result<void> operator()(const protocol::ListenerOff&) const {
    return append_for_all({.type = EventType::listener_off});
  }

  Result<void> operator()(const protocol::SetListenerAir& set) const {
    return append_for_all(
        {.type = EventType::listener_air, .value = set.temperature_c, .ramp_s = set.humidity_percent});
  }

  Result<void> operator()(const protocol::ClearAll&) const {
    for (const ObjectSnapshot& object : rack.objects()) static_cast<void>(append(*object, {.type = EventType::clear}));
    return {};
  }

 private:
  Result<void> append_touch(const protocol::ObjectRef& ref, Vec3 point_m, synth::Touch touch, Vec3 direction,
                            const char* what) const {
    const auto object = rack.find(ref);
    if (!object) return fail(object.error());
    if (auto good = check_point(point_m, **object); !good) return good;
    const double size = length(direction);
    if (!(size > 0))
      return fail(ErrorKind::bad_input, "the " + std::string(what) + " must not be 0 0 0; any length but 0 will do");
    touch.direction = (1 / size) * direction;
    Event event{.type = EventType::touch, .point_m = point_m};
    event.touch = touch;
    return append(**object, event);
  }

  Result<void> append(const protocol::ObjectRef& ref, const Event& event) const {
    const auto object = rack.find(ref);
    if (!object) return fail(object.error());
    return append(**object, event);
  }

  // An event that happens to no object.
  Result<void> append_for_all(Event event) const {
    event.frame = frame;
    events.push_back(event);
    return {};
  }

  Result<void> append(const ObjectState& object, Event event) const {
    event.frame = frame;
    event.object = object.number;
    events.push_back(event);
    return {};
  }
};

}  // namespace

Result<void> append_events(const protocol::MixerRequest& request, const Rack& rack, synth::Frame frame,
                           std::vector<Event>& events) {
  return protocol::visit(AppendEvents{rack, frame, events}, request);
}

}  // namespace ringdown::session
