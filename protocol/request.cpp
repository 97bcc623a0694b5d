#include "protocol/request.h"

namespace ringdown::protocol {

Request request_for(const synth::Event& event, const ObjectRef& object) {
  const auto request = [&]<class Verb>(const Verb& verb) -> Request {
    if constexpr (requires { verb.as_public(); }) {
      return request_for({event.frame, event.object, verb.as_public()}, object);
    } else if constexpr (Verb::kEffect == synth::Effect::listens) {
      return OnListener<Verb>{verb};
    } else if constexpr (requires { verb.other; }) {
      return OnObject<Verb>{object, verb, {.number = verb.other}};
    } else {
      return OnObject<Verb>{object, verb};
    }
  };
  return visit(request, event.verb);
}

std::vector<Hold> dampers_for(const modal::Dampers& dampers, const ObjectRef& object) {
  std::vector<Hold> holds;
  for (const auto& [number, damper] : dampers) holds.push_back({object, damper, number});
  return holds;
}

}  // namespace ringdown::protocol

template class ringdown::detail::OneOfStorage<ringdown::protocol::Requests>;
