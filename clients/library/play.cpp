#include "clients/library/play.h"

#include "server/session/request_events.h"

#include <string>
#include <utility>

namespace ringdown::library {

ringdown_result play(ringdown_mixer* mixer, std::int64_t frame, protocol::MixerRequest blank,
                     std::span<const double> numbers, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (const auto wrong = protocol::fill(blank, numbers)) {
      return out_of_range(protocol::verb_addresses()[blank.index()], *wrong);
    }
    if (session::is_too_far_ahead(mixer->rack.mixer(), frame))
      return fail(ErrorKind::bad_input, "frame lies more than an hour ahead");
    mixer->events.clear();
    const auto made = session::append_events(blank, mixer->rack, frame, mixer->events);
    if (!made) return made;
    for (const synth::Event& event : mixer->events) {
      const synth::Effect effect = effect_of(event);
      if (effect == synth::Effect::excites || effect == synth::Effect::begins) {
        if (auto whole = mixer->breakage.check_whole(event.object); !whole) return whole;
      }
      if (mixer->rack.push(synth::Producer::control, event)) continue;
      ++mixer->dropped;
      return fail(ErrorKind::refused, "dropped, because {} events are waiting already; send fewer between two blocks",
                  synth::kQueueCapacity);
    }
    return {};
  });
}

}  // namespace ringdown::library
