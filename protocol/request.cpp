#include "protocol/request.h"

namespace ringdown::protocol {

Request request_for(const synth::Event& event, const ObjectRef& object) {
  switch (event.type) {
    case synth::EventType::strike:
      return Strike{object, event.point_m, event.impulse_ns, event.contact_time_s};
    case synth::EventType::strike_vertex:
      return StrikeVertex{object, event.vertex, event.impulse_ns, event.contact_time_s};
    case synth::EventType::gain:
      return SetGain{object, event.value, event.ramp_s};
    case synth::EventType::pan:
      return SetPan{object, event.value};
    case synth::EventType::contact:
      return KeepContact{object, event.point_m, event.contact};
    case synth::EventType::ring:
      return RingModes{object, event.vertex, event.count, event.value};
    case synth::EventType::click:
      return Click{object, event.impulse_ns, event.contact_time_s};
    case synth::EventType::clear:
      break;
  }
  return ClearObject{object, event.ramp_s};
}

std::vector<Hold> holds_for(const modal::Touches& touches, const ObjectRef& object) {
  std::vector<Hold> holds;
  for (const auto& [number, touch] : touches) holds.push_back({object, touch, number});
  return holds;
}

}  // namespace ringdown::protocol
