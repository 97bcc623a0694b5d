#include "server/session/session.h"

#include "protocol/bulk.h"

#include <concepts>

namespace ringdown::session {
namespace {

template <class... Cases>
struct Match : Cases... {
  using Cases::operator()...;
};

const protocol::ObjectRef* object_of(const protocol::Request& request) {
  return std::visit(
      [](const auto& r) -> const protocol::ObjectRef* {
        if constexpr (requires {
                        { r.object } -> std::same_as<const protocol::ObjectRef&>;
                      })
          return &r.object;
        return nullptr;
      },
      request);
}

}  // namespace

bool Session::is_event(const protocol::Request& request) {
  return std::visit(
      Match{[](const protocol::Strike&) { return true; }, [](const protocol::StrikeVertex&) { return true; },
            [](const protocol::StrikeMany&) { return true; }, [](const protocol::SetGain&) { return true; },
            [](const protocol::SetPan&) { return true; }, [](const protocol::ClearObject&) { return true; },
            [](const protocol::SetContact&) { return true; }, [](const protocol::Click&) { return true; },
            [](const protocol::RingModes&) { return true; }, [](const protocol::ClearAll&) { return true; },
            [](const auto&) { return false; }},
      request);
}

Result<std::vector<synth::Event>> Session::events_of(const protocol::Request& request, synth::Frame frame) const {
  const auto latest = rack_.mixer().counters().frames.load(std::memory_order_relaxed) +
                      static_cast<synth::Frame>(kMaxAhead_s * sample_rate_hz());
  if (frame > latest)
    return fail(ErrorKind::bad_input,
                "its time tag is more than " + std::to_string(static_cast<int>(kMaxAhead_s)) + " s ahead");
  std::vector<synth::Event> events;
  if (std::holds_alternative<protocol::ClearAll>(request)) {
    for (const RackObject& object : rack_.objects()) events.push_back(*event_for(request, object, frame));
    return events;
  }
  if (const auto* bulk = std::get_if<protocol::StrikeMany>(&request)) return events_of(*bulk, frame);
  const auto object = rack_.find(*object_of(request));
  if (!object) return fail(object.error());
  const auto event = event_for(request, *object, frame);
  if (!event) return fail(event.error());
  events.push_back(*event);
  return events;
}

Result<std::vector<synth::Event>> Session::events_of(const protocol::StrikeMany& bulk, synth::Frame frame) const {
  const auto strikes = protocol::decode_strikes(bulk.records);
  if (!strikes) return fail(strikes.error());
  std::vector<synth::Event> events;
  for (const protocol::BulkStrike& strike : *strikes) {
    const protocol::ObjectRef ref{.number = strike.object};
    const protocol::Request one =
        strike.vertex
            ? protocol::Request(protocol::StrikeVertex{ref, *strike.vertex, strike.impulse_ns, strike.contact_time_s})
            : protocol::Request(protocol::Strike{ref, strike.point_m, strike.impulse_ns, strike.contact_time_s});
    const auto later = static_cast<synth::Frame>(std::llround(strike.delay_s * sample_rate_hz()));
    const auto object = rack_.find(ref);
    const auto event = object ? event_for(one, *object, frame + later) : fail(object.error());
    if (!event)
      return fail(event.error().kind, "record " + std::to_string(events.size() + 1) + " " + event.error().message);
    events.push_back(*event);
  }
  return events;
}

Result<void> Session::check(const protocol::Request& request, synth::Frame frame) const {
  const auto events = events_of(request, frame);
  if (!events) return fail(events.error());
  return {};
}

Result<void> Session::play(const protocol::Request& request, synth::Frame frame) {
  const auto events = events_of(request, frame);
  if (!events) return fail(events.error());
  std::size_t lost = 0;
  for (const synth::Event& event : *events) {
    switch (merger_.add(event)) {
      case StrikeMerger::Verdict::merged:
        ++merged_;
        break;
      case StrikeMerger::Verdict::held:
        break;
      case StrikeMerger::Verdict::full:
        flush();
        [[fallthrough]];
      case StrikeMerger::Verdict::pass:
        lost += push(event);
    }
  }
  if (lost == 0) return {};
  return drop(lost, std::to_string(synth::kQueueCapacity) + " events are waiting already");
}

// How many events were lost: 0 or 1.
std::size_t Session::push(const synth::Event& event) { return rack_.push(synth::Producer::control, event) ? 0 : 1; }

void Session::flush() {
  for (const synth::Event& event : merger_.held()) dropped_ += push(event);
  merger_.clear();
}

tl::unexpected<Error> Session::drop(std::size_t events, const std::string& because) {
  dropped_ += events;
  return fail(ErrorKind::refused, "dropped, because " + because + "; send fewer at once");
}

Result<std::optional<std::int32_t>> Session::perform(const protocol::Request& request, synth::Frame frame) {
  using namespace protocol;
  using Answer = Result<std::optional<std::int32_t>>;
  const auto number = [](auto value) { return std::optional(static_cast<std::int32_t>(value)); };
  const auto none = [](const Result<void>& outcome) -> Answer {
    if (!outcome) return fail(outcome.error());
    return std::nullopt;
  };
  return std::visit(
      Match{[&](const LoadObject& load) -> Answer { return load_object(load).map(number); },
            [&](const SetMaterial& material) { return none(rack_.set_material(material.object, material.scale)); },
            [&](const protocol::SetDamper& hold) {
              return none(rack_.set_dampers(hold.object, {{hold.number, hold.damper}}, frame));
            },
            [&](const SelectModes& select) { return none(rack_.select_modes(select.object, select.range)); },
            [&](const SetGroup& set) { return none(rack_.set_group(set.object, set.group.value_or(""))); },
            [&](const Excite& e) { return none(rack_.excite(e.input - 1, e.object, e.point_m, e.force_n)); },
            [&](const FreeObject& object) { return none(free_object(object)); },
            [&](const SceneLoad& scene) -> Answer { return scene_.load(scene.path, frame).map(number); },
            [&](const ScenePause& pause) { return none(scene_.pause(pause.paused)); },
            [&](const SpawnBox& box) -> Answer { return scene_.spawn(box).map(number); },
            [&](const SpawnSphere& sphere) -> Answer { return scene_.spawn(sphere).map(number); },
            [&](const SceneClear&) { return none(scene_.clear()); },
            [&](const TestTone& tone) -> Answer {
              rack_.mixer().test_tone().set(tone.amplitude, tone.frequency_hz);
              return std::nullopt;
            },
            [&](const ScenePush& push) {
              return none(scene_.push(static_cast<scene::BodyId>(push.body), push.impulse_ns));
            },
            [](const auto&) -> Answer { return fail(ErrorKind::refused, "this request is not for a session"); }},
      request);
}

Result<synth::ObjectNumber> Session::load_object(const protocol::LoadObject& load) {
  const auto number = rack_.load(load.name, load.bank_path);
  if (!number) return number;
  if (const auto followed = scene_.object_changed(*rack_.find({.name = load.name})); !followed) {
    return fail(followed.error().kind,
                "the object has its new bank, but the scene goes on with the old one: " + followed.error().message);
  }
  return number;
}

Result<void> Session::free_object(const protocol::FreeObject& request) {
  const auto object = rack_.find(request.object);
  if (object) scene_.object_freed(object->number);
  return rack_.free(request.object);
}

}  // namespace ringdown::session
