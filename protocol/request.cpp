#include "protocol/request.h"

namespace ringdown::protocol {

template class OneOf<Requests>;

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
      return SetContact{object, event.point_m, event.contact};
    case synth::EventType::touch:
      switch (event.touch.kind) {
        case synth::Touch::Kind::bow:
          return SetBow{object, event.point_m, event.touch};
        case synth::Touch::Kind::mallet:
          return HitMallet{object, event.point_m, event.touch.speed_m_s * event.touch.direction, event.touch};
        case synth::Touch::Kind::rub:
          return SetContact{object, event.point_m, event.contact};
        case synth::Touch::Kind::couple:
          break;
      }
      return SetCoupling{object, event.point_m, {.number = event.touch.other}, event.touch};
    case synth::EventType::ring:
      return RingModes{object, event.vertex, event.count, event.value};
    case synth::EventType::click:
      return Click{object, event.impulse_ns, event.contact_time_s};
    case synth::EventType::pose:
      return SetPose{object, {event.point_m, event.rotation}};
    case synth::EventType::listener:
      return SetListener{{event.point_m, event.rotation}};
    case synth::EventType::listener_off:
      return ListenerOff{};
    case synth::EventType::listener_air:
      return SetListenerAir{event.value, event.ramp_s};
    case synth::EventType::clear:
      break;
  }
  return ClearObject{object, event.ramp_s};
}

std::vector<SetDamper> dampers_for(const modal::Dampers& dampers, const ObjectRef& object) {
  std::vector<SetDamper> holds;
  for (const auto& [number, damper] : dampers) holds.push_back({object, damper, number});
  return holds;
}

}  // namespace ringdown::protocol
