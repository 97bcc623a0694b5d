#include "protocol/request.h"

namespace ringdown::protocol {

Request request_for(const Event& event, const ObjectRef& object) {
  switch (event.type) {
    case EventType::strike:
      return Strike{object, event.point_m, event.impulse_ns, event.contact_time_s};
    case EventType::strike_vertex:
      return StrikeVertex{object, event.vertex, event.impulse_ns, event.contact_time_s};
    case EventType::gain:
      return SetGain{object, event.value, event.ramp_s};
    case EventType::pan:
      return SetPan{object, event.value};
    case EventType::contact:
      return KeepContact{object, event.point_m, event.contact};
    case EventType::ring:
      return RingModes{object, event.vertex, event.count, event.value};
    case EventType::click:
      return Click{object, event.impulse_ns, event.contact_time_s};
    case EventType::clear:
      break;
  }
  return ClearObject{object, event.ramp_s};
}

}  // namespace ringdown::protocol
