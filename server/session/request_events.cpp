#include "server/session/request_events.h"

#include "protocol/bulk.h"

#include <cmath>
#include <string>

namespace ringdown::session {
namespace {

using synth::Event;

// The errors in this file name no arguments or addresses, because OSC, the C library and Python have different names
// for them.
tl::unexpected<Error> no_such(const char* what, std::size_t number, std::size_t count, const ObjectState& object) {
  return fail(ErrorKind::bad_input, "there is no {} {}: \"{}\" has {}, which are numbered from 0", what, number,
              object.name, count);
}

Result<void> check_direction(const char* what, const Vec3& direction) {
  if (length(direction) > 0) return {};
  return fail(ErrorKind::bad_input, "the {} must not be 0 0 0; any other length is allowed", what);
}

// Checks a verb against its object, beyond the ranges of single numbers. Most verbs have a point at which they act, or
// nothing to check. A check may normalise values that come in single precision.
template <class Verb>
Result<void> check(Verb& verb, const ObjectState& object) {
  if constexpr (requires { verb.point_m; }) {
    if (auto good = check_point(verb.point_m, object); !good) return good;
  }
  if constexpr (requires { verb.velocity_m_s; }) return check_direction("velocity", verb.velocity_m_s);
  if constexpr (requires { verb.direction; }) {
    if (auto good = check_direction("direction", verb.direction); !good) return good;
    verb.direction = (1 / length(verb.direction)) * verb.direction;
  }
  return {};
}

Result<void> check(synth::verb::StrikeVertex& strike, const ObjectState& object) {
  const std::size_t points = object.map->bank().point_count();
  if (strike.vertex >= points) return no_such("sample point", strike.vertex, points, object);
  return {};
}

Result<void> check(synth::verb::Ring& ring, const ObjectState& object) {
  const std::size_t modes = object.map->bank().mode_count();
  if (ring.first >= modes) return no_such("mode", ring.first, modes, object);
  return {};
}

Result<void> check_cavity(const ObjectState& object) {
  if (object.map->bank().cavity) return {};
  return fail(ErrorKind::bad_input, "\"{}\" has no air that sounds; bake it with [cavity]", object.name);
}
Result<void> check(synth::verb::Slap& /*slap*/, const ObjectState& object) { return check_cavity(object); }
Result<void> check(synth::verb::Blow& /*blow*/, const ObjectState& object) { return check_cavity(object); }

// Normalises the quaternion, because transport in single precision may change its length slightly.
Result<void> check_turn(Rotation& turn) {
  if (std::abs(norm(turn) - 1) > 0.01) {
    return fail(ErrorKind::bad_input, "the rotation w x y z must be a quaternion of length 1; 1 0 0 0 is not turned");
  }
  turn = normalized(turn);
  return {};
}

Result<void> check(synth::verb::Pickup& pickup, const ObjectState& object) {
  const double size = length(pickup.direction);
  if (!(size > 0)) return {};
  if (auto good = check_point(pickup.point_m, object); !good) return good;
  if (object.map->bank().mode_count() > synth::kMaxProbedColumns) {
    return fail(ErrorKind::too_large,
                "\"{}\" has more than the {} modes that a pickup can feel; bake it with `ringdown bake --keep`",
                object.name, synth::kMaxProbedColumns);
  }
  pickup.direction = (1 / size) * pickup.direction;
  return {};
}

Result<void> check(synth::verb::Pose& verb, const ObjectState& /*object*/) { return check_turn(verb.pose.rotation); }

struct AppendEvents {
  const Rack& rack;
  synth::Frame frame;
  std::vector<Event>& events;

  template <class Verb>
  Result<void> operator()(const protocol::OnObject<Verb>& request) const {
    Verb verb = request.verb;
    if constexpr (requires { verb.other; }) {
      const auto other = rack.find(request.other);
      if (!other) return fail(other);
      if (auto good = check_point(verb.other_point_m, **other); !good) return good;
      verb.other = (*other)->number;
    }
    const auto object = rack.find(request.object);
    if (!object) return fail(object);
    if constexpr (requires { verb.other; }) {
      if (verb.other == (*object)->number) {
        return fail(ErrorKind::bad_input, "an object cannot touch itself; name another one");
      }
    }
    if (auto good = check(verb, **object); !good) return good;
    events.push_back({frame, (*object)->number, verb});
    return {};
  }

  template <class Verb>
  Result<void> operator()(const protocol::OnListener<Verb>& request) const {
    Verb verb = request.verb;
    if constexpr (requires { verb.pose; }) {
      if (auto good = check_turn(verb.pose.rotation); !good) return good;
    }
    events.push_back({.frame = frame, .verb = verb});
    return {};
  }

  Result<void> operator()(const protocol::StrikeMany& bulk) const {
    const auto strike = [](const AppendEvents& later, const protocol::ObjectRef& object,
                           const protocol::BulkStrike& one) {
      if (one.vertex) return later(protocol::StrikeVertex{object, {*one.vertex, one.impulse_ns, one.contact_time_s}});
      return later(protocol::Strike{object, {one.point_m, one.impulse_ns, one.contact_time_s}});
    };
    return append_records(protocol::decode_strikes(bulk.records), strike);
  }

  Result<void> operator()(const protocol::PoseMany& bulk) const {
    const auto place = [](const AppendEvents& later, const protocol::ObjectRef& object, const protocol::BulkPose& one) {
      return later(protocol::SetPose{object, {one.pose}});
    };
    return append_records(protocol::decode_poses(bulk.records), place);
  }

  Result<void> operator()(const protocol::ClearAll&) const {
    for (const ObjectSnapshot& object : rack.objects()) {
      events.push_back({frame, object->number, synth::verb::Clear()});
    }
    return {};
  }

 private:
  // Appends each record at its own time, by `append(later, object, record)`.
  template <class Record, class Append>
  Result<void> append_records(const Result<std::vector<Record>>& records, const Append& append) const {
    if (!records) return fail(records);
    for (std::size_t i = 0; i < records->size(); ++i) {
      const Record& one = (*records)[i];
      const auto delay = static_cast<synth::Frame>(std::llround(one.delay_s * rack.mixer().sample_rate_hz()));
      const auto done = append(AppendEvents{rack, frame + delay, events}, {.number = one.object}, one);
      if (!done) return fail(formatted("record {}", i + 1), done);
    }
    return {};
  }
};

}  // namespace

Result<void> append_events(const protocol::MixerRequest& request, const Rack& rack, synth::Frame frame,
                           std::vector<Event>& events) {
  return visit(AppendEvents{rack, frame, events}, request);
}

}  // namespace ringdown::session
