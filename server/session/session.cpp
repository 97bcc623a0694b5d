#include "server/session/session.h"

#include "server/session/request_events.h"

namespace ringdown::session {
namespace {

// Returns true if a request acts on the object itself, which must then be whole.
bool acts(const synth::Event& event) {
  const synth::Effect effect = effect_of(event);
  return effect == synth::Effect::excites || effect == synth::Effect::begins;
}

}  // namespace

Result<void> Session::check_frame(synth::Frame frame) const {
  if (!is_too_far_ahead(rack_.mixer(), frame)) return {};
  return fail(ErrorKind::bad_input, "its time tag is more than {} s ahead", static_cast<int>(kMaxAhead_s));
}

Result<void> Session::check(const protocol::MixerRequest& request, synth::Frame frame) {
  if (auto good = check_frame(frame); !good) return good;
  events_.clear();
  if (auto appended = append_events(request, rack_, frame, events_); !appended) return appended;
  for (const synth::Event& event : events_) {
    if (!acts(event)) continue;
    if (auto whole = breakage_.check_whole(event.object); !whole) return whole;
    if (scene_.pieces().is_broken(event.object))
      return fail(ErrorKind::refused,
                  "its body has broken in the scene; strike its pieces, or load the scene again to have it whole");
  }
  return {};
}

Result<void> Session::check(const protocol::TimedWorkerRequest& request, synth::Frame frame) {
  if (auto good = check_frame(frame); !good) return good;
  return visit(Overloaded{[&](const protocol::Hold& set) -> Result<void> {
                            const auto object = rack_.find(set.object);
                            if (!object) return fail(object);
                            if (!(set.damper.damping_ns_m > 0))
                              return {};  // removes the damper; its point does not matter
                            return check_point(set.damper.point_m, **object);
                          },
                          [&](const protocol::SetFill& set) -> Result<void> {
                            const auto object = rack_.find(set.object);
                            if (!object) return fail(object);
                            return modal::check_level((*object)->baked_map->bank(),
                                                      set.level_m / (*object)->material.size);
                          },
                          [&](const protocol::SetResonator& set) -> Result<void> {
                            const auto object = rack_.find(set.object);
                            if (!object) return fail(object);
                            if (const auto tubes = modal::as_tuned((*object)->baked_map->bank()); !tubes)
                              return fail("resonator", tubes);
                            return {};
                          },
                          [&](const protocol::BreakObject& blow) { return breakage_.check(blow); }},
               request);
}

Result<void> Session::play(const protocol::MixerRequest& request, synth::Frame frame) {
  if (auto good = check(request, frame); !good) return good;
  std::size_t lost = 0;
  for (const synth::Event& event : events_) {
    // An earlier blow of this request may have broken the object.
    if (acts(event) && !breakage_.check_whole(event.object)) continue;
    if (const auto broken = breakage_.break_by(event, synth::Producer::control)) {
      lost += broken->lost;
      continue;
    }
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
  return drop(lost, formatted("{} events are waiting already", synth::kQueueCapacity));
}

// Returns the number of lost events: 0 or 1.
std::size_t Session::push(const synth::Event& event) { return rack_.push(synth::Producer::control, event) ? 0 : 1; }

void Session::flush() {
  for (const synth::Event& event : merger_.held()) dropped_ += push(event);
  merger_.clear();
}

tl::unexpected<Error> Session::drop(std::size_t events, const std::string& because) {
  dropped_ += events;
  return fail(ErrorKind::refused, "dropped, because " + because + "; send fewer at once");
}

namespace {

using Answer = Result<std::optional<std::int32_t>>;

Answer number(const auto& outcome) {
  return outcome.map([](auto value) { return std::optional(static_cast<std::int32_t>(value)); });
}

Answer none(const Result<void>& outcome) {
  if (!outcome) return fail(outcome);
  return std::nullopt;
}

}  // namespace

Answer Session::perform(const protocol::WorkerRequest& request, synth::Frame frame) {
  using namespace protocol;
  return visit(Overloaded{
                   [&](const LoadObject& load) { return number(load_object(load)); },
                   [&](const FreeObject& removed) {
                     if (const auto object = rack_.find(removed.object)) scene_.object_freed((*object)->number);
                     return none(rack_.free(removed.object));
                   },
                   [&](const SetMaterial& set) { return none(rack_.set_material(set.object, set.scale)); },
                   [&](const SelectModes& select) { return none(rack_.select_modes(select.object, select.range)); },
                   [&](const SetGroup& set) { return none(rack_.set_group(set.object, set.group.value_or(""))); },
                   [&](const SetMute& set) { return none(rack_.set_heard(set.object, &ObjectState::mute, set.on)); },
                   [&](const SetSolo& set) { return none(rack_.set_heard(set.object, &ObjectState::solo, set.on)); },
                   [&](const ArmObject& arm) {
                     return number(arm.pattern < 0 ? breakage_.arm(arm.object)
                                                   : breakage_.arm(arm.object, static_cast<std::size_t>(arm.pattern)));
                   },
                   [&](const SetStrength& set) { return none(breakage_.set_strength(set.object, set.strength_pa)); },
                   [&](const MendObject& mend) { return none(breakage_.mend(mend.object)); },
                   [&](const Excite& e) { return none(rack_.excite(e.input - 1, e.object, e.point_m, e.force_n)); },
                   [&](const SceneLoad& scene) { return number(scene_.load(scene.path, frame, scene.paused)); },
                   [&](const ScenePause& pause) { return none(scene_.pause(pause.paused)); },
                   [&](const SpawnBox& box) { return number(scene_.spawn(box)); },
                   [&](const SpawnSphere& sphere) { return number(scene_.spawn(sphere)); },
                   [&](const SceneClear&) { return none(scene_.clear()); },
                   [&](const SceneRemove& change) { return none(scene_.change(change)); },
                   [&](const SceneRestore& change) { return none(scene_.change(change)); },
                   [&](const ScenePlace& change) { return none(scene_.change(change)); },
                   [&](const ScenePush& change) { return none(scene_.change(change)); },
                   [&](const TestTone& tone) {
                     rack_.mixer().test_tone().set(tone.amplitude, tone.frequency_hz);
                     return none({});
                   },
               },
               request);
}

Answer Session::perform(const protocol::TimedWorkerRequest& request, synth::Frame frame) {
  if (const auto good = check(request, frame); !good) return fail(good);
  return visit(
      Overloaded{
          [&](const protocol::Hold& set) {
            return none(rack_.set_dampers(set.object, {{set.number, set.damper}}, frame));
          },
          [&](const protocol::SetFill& set) { return none(rack_.set_level(set.object, set.level_m, frame)); },
          [&](const protocol::SetResonator& set) { return none(rack_.set_tubes(set.object, set.tuning, frame)); },
          [&](const protocol::BreakObject& blow) -> Answer {
            const auto broken = breakage_.break_object(blow, frame);
            if (!broken) return fail(broken);
            if (broken->lost > 0)
              return drop(broken->lost, formatted("{} events are waiting already", synth::kQueueCapacity));
            return static_cast<std::int32_t>(broken->pieces);
          }},
      request);
}

Result<synth::ObjectNumber> Session::load_object(const protocol::LoadObject& load) {
  const auto number = rack_.load(load.name, load.bank_path);
  if (!number) return number;
  if (const auto followed = scene_.object_changed(**rack_.find({.name = load.name})); !followed) {
    return fail(followed.error().kind,
                "the object has its new bank, but the scene continues with the old one: " + followed.error().message);
  }
  return number;
}

}  // namespace ringdown::session
