#include "engine/synth/stage.h"

#include "engine/synth/modes/sane_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::synth {
namespace {

// A member that has moved by this share of what it may is heard from where it is now when it is struck. What still
// rings of it then changes its level at once, by 0.1 dB at least and 1 dB at most, which its own strike hides.
constexpr double kStruckDrift = 0.1;
constexpr double kMaxClickImpulse_ns = 1e9, kMaxClick_s = 1;

// Not-a-number lies in no range.
bool is_sane(const Contact& contact) REALTIME {
  const Texture& t = contact.texture;
  const auto within = [](double value, double min, double max) REALTIME { return value >= min && value <= max; };
  return within(dot(contact.force_n, contact.force_n), 0, kMaxEventValue * kMaxEventValue) &&
         within(contact.slip_m_s, 0, kMaxEventValue) && within(contact.roll_m_s, 0, kMaxEventValue) &&
         within(t.roughness_m, 0, 1) && within(t.correlation_m, 1e-9, 1e3) && within(t.spectral_slope, -10, 0) &&
         within(t.shortest_m, 0, 1e3) && within(contact.surfaces[0].speed_m_s, 0, kMaxEventValue) &&
         within(contact.surfaces[1].speed_m_s, 0, kMaxEventValue) && within(contact.finish_width_m, 0, 1e3) &&
         within(contact.relief_width_m, 0, 1e3);
}
bool is_sane(const verb::Contact& event) REALTIME { return is_sane(event.contact); }
bool is_sane(const verb::Blow& blow) REALTIME { return blow.pressure_pa >= 0 && blow.pressure_pa <= kMaxEventValue; }

}  // namespace

Stage::Stage(EventQueue& events, VoiceRegistry& voices, MixerCounters& counters)
    : events_(events),
      voices_(voices),
      counters_(counters),
      active_objects_(kMaxObjects),
      active_groups_(kMaxVoices),
      sources_(kMaxObjects + kMaxVoices + kMaxTouches) {}

Stage::~Stage() {
  for (const std::unique_ptr<Object>& object : objects_.all()) object->voices.free_all();
}

void Stage::make_object(ObjectNumber number) {
  if (!forces_) forces_ = std::make_unique<Forces>(counters_);
  objects_.make(number);
}

void Stage::execute(const Command& command, const verb::Strike& impulse, Frame now) REALTIME {
  using Kind = Command::Kind;
  if (command.kind == Kind::found_group) {
    command.group->found();
    return;
  }
  if (command.kind == Kind::connect || command.kind == Kind::disconnect) {
    const auto before = forces_ ? forces_->exciters.target_of(command.input) : std::nullopt;
    if (before) forces_->exciters.disconnect(command.input, objects_.find(*before)->exciters);
    if (command.kind == Kind::disconnect) return;
  }
  object_limit_ = std::max<std::size_t>(object_limit_, command.object + 1);
  Object& object = *objects_.find(command.object);
  part(object, now);
  if (command.kind == Kind::connect) {
    return forces_->exciters.connect(command.input, command.object, impulse, object.voices.current(), object.exciters);
  }
  if (command.kind == Kind::assign) return object.strip.set_bus(command.channel);
  if (command.kind == Kind::silence || command.kind == Kind::unsilence) {
    return object.strip.set_silent(command.kind == Kind::silence, now, object.voices.current() ? command.ramp : 0);
  }
  if (command.kind == Kind::remove) object.voices.fade_out({});
  object.voices.replace(command.voice, command.kind == Kind::retune);
  forces_->exciters.refit(object.voices.current(), object.exciters);
  Pickups::refit(object.pickups, object.voices);
  active_objects_.add(object);  // the next chunk finds out what rings, and retires what does not
}

// Carries out a verb that places something.
void Stage::place(const Event& event, Frame now, double sample_rate_hz) REALTIME {
  const auto refuse = [this]() REALTIME { count(counters_.refused); };
  const auto place = [&]<class One>(const One& one) REALTIME {
    if constexpr (std::is_same_v<One, verb::Pose>) {
      if (!is_sane(one.pose)) return refuse();
      Object* const found = objects_.find(event.object);
      if (!found) return refuse();
      Object& object = *found;
      const bool known = object.placement.track.known();
      Frame seen = event.frame;
      if (listening_.travel_time())
        seen += std::llround(listening_.travel_frames(one.pose.position_m, now, sample_rate_hz));
      object.placement.track.add(seen, one.pose, now, sample_rate_hz);
      if (!known && listening_.on()) part(object, now);
    } else if constexpr (std::is_same_v<One, verb::Listener>) {
      if (!is_sane(one.pose)) return refuse();
      const bool begins = !listening_.on();
      listening_.place(event.frame, one.pose, now, sample_rate_hz);
      for (std::size_t i = 0; begins && i < object_limit_; ++i) {
        Object* const object = objects_.find(i);
        if (object && object->placement.track.known()) part(*object, now);
      }
    } else if constexpr (std::is_same_v<One, verb::ListenerOff>) {
      listening_.leave();
    } else if constexpr (std::is_same_v<One, verb::ListenerAir>) {
      if (!std::isfinite(one.temperature_c) || !std::isfinite(one.humidity_percent)) return refuse();
      listening_.set_air({one.temperature_c, one.humidity_percent});
    } else {
      static_assert(!is_placing(One::kEffect), "a verb that places something is carried out here");
    }
  };
  visit_now(place, event.verb);
}

std::size_t Stage::listen_to_inputs(Chunk& chunk, std::size_t rest) REALTIME {
  if (object_limit_ == 0 || !forces_->exciters.take_inputs()) return rest;
  for (std::size_t input = 0; input < kMaxInputs; ++input) {
    const float* const samples = chunk.inputs[input];
    const std::optional<ObjectNumber> target = forces_->exciters.target_of(input);
    if (!samples || !target) continue;
    rest = std::min(rest, kChunkFrames);
    chunk.input_sounds[input] = std::any_of(samples, samples + rest, [](float x) REALTIME { return x != 0; });
    if (chunk.input_sounds[input]) active_objects_.add(*objects_.find(*target));
  }
  return rest;
}

// Events leave the queue in order of frames until the next one lies beyond the chunk, there is no time for it, or the
// chunk's table of events is full; in either case it waits. Each event then goes through two steps. accept() does what
// must be done before anything is rendered: it starts clicks, contact pulses and lasting contacts, and takes an object
// out of its instance group when the event needs the object alone. Only when all events of the chunk are accepted are
// those that remain appended to their sources, because an object that leaves or joins a group changes its source.
void Stage::route_events(const Chunk& chunk, bool exact_contacts, Shedding& shedding, Workspace& workspace) REALTIME {
  if (chunk.listening) part_drifted(chunk);
  events_waited_ = false;
  std::size_t count = 0, sent_on = 0;
  while (count < due_.size() && sent_on < due_.size()) {
    const EventQueue::Pending* const next = events_.next_before(chunk.end());
    if (!next) break;
    Object* const found = objects_.find(next->event.object);
    if (!found) {  // there never was such an object
      const Effect effect = effect_of(next->event.verb);
      if (effect == Effect::excites || effect == Effect::begins) synth::count(counters_.refused);
      events_.release(next->event);
      events_.pop();
      continue;
    }
    Object& object = *found;
    if (const Frame way = next->travelled ? 0 : travels(next->event, object, chunk); way > 0) {
      EventQueue::Pending heard = *next;
      heard.event.frame = std::max(heard.event.frame, chunk.begin) + way;
      heard.travelled = true;
      events_.pop();
      events_.put_back(heard);
      ++sent_on;
      continue;
    }
    events_waited_ = !shedding.may_accept(object.units_of(next->event.verb));
    if (events_waited_) break;
    DueEvent& due = due_[count];
    due = {events_.event_of(next->event), &object, 0, *next, false, nullptr};
    due.event.frame = std::max(due.event.frame, chunk.begin);  // it may have waited since an earlier chunk
    due.offset = static_cast<std::size_t>(due.event.frame - chunk.begin);
    events_.pop();
    if (accept(due, chunk, exact_contacts, shedding, workspace)) {
      ++count;
    } else {
      events_.release(due.queued.event);
    }
  }
  due_count_ = count;
  if (object_limit_ > 0) forces_->touches.regroup();
  for (std::size_t i = 0; i < count; ++i) give_to_source(due_[i], chunk, shedding, workspace);
}

// Frames for which the sound of an event travels: it leaves where the object is then, and the object's track is late by
// that time (Listening::set_travel_time()), so the time is found by going there and looking again.
Frame Stage::travels(const QueuedEvent& event, const Object& object, const Chunk& chunk) const REALTIME {
  const PoseTrack& track = object.placement.track;
  if (!chunk.listening || !chunk.listening->travel_time() || !is_sound(effect_of(event.verb)) || !track.known())
    return 0;
  const Voice* const voice = object.voices.current();
  const Frame now = std::max(event.frame, chunk.begin);
  double way = 0;
  for (int look = 0; look < 4; ++look) {
    const Frame heard = now + std::llround(way);
    const Pose pose = track.at(heard, chunk.sample_rate_hz).pose;
    const Vec3 arm = voice ? rotated(pose.rotation, voice->table().whole().origin_m) : Vec3{};
    way = chunk.listening->travel_frames(pose.position_m + arm, heard, chunk.sample_rate_hz);
  }
  return std::llround(way);
}

// Begins what an event begins at once. True when the event is for its object or group to play.
bool Stage::accept(DueEvent& due, const Chunk& chunk, bool exact_contacts, const Shedding& shedding,
                   Workspace& workspace) REALTIME {
  Object& object = *due.object;
  const auto rings_alone = [&]() REALTIME {
    if (object.member.shares_states) shedding.worked(object.units_to_share(), workspace);
    part(object, chunk.begin);
    return true;
  };
  const auto begins = [&]<class One>(const One& one) REALTIME {
    if constexpr (std::is_same_v<One, verb::Strike> || std::is_same_v<One, verb::StrikeVertex> ||
                  std::is_same_v<One, verb::Slap>) {
      return !(exact_contacts && !shedding.tight() && starts_pulse(one, due, chunk));
    } else if constexpr (TwoWay<One>) {
      const One felt = one;  // the event may become another one
      switch (accept_touch(touch_of(felt), due, chunk, shedding)) {
        case Felt::taken:
          return true;
        case Felt::as_strike:
          due.event.verb = Touches::strike_of(touch_of(felt), object);
          if constexpr (std::is_same_v<One, verb::Collision>) {  // the scene knows
            if (length(felt.impulse_ns) > 0) {
              due.event.verb = verb::Strike{felt.point_m, felt.impulse_ns, felt.contact_time_s};
            }
          }
          return true;
        case Felt::one_way:
          if constexpr (std::is_same_v<One, verb::Rub>) {
            const verb::Contact contact = felt.as_public();
            due.event.verb = contact;
            return accept_lasting(contact, due, chunk) && rings_alone();
          }
          return false;
        case Felt::not_at_all:
          return false;
      }
      return false;
    } else if constexpr (std::is_same_v<One, verb::Click>) {
      start_click(one, due, chunk, shedding);
      return false;
    } else if constexpr (std::is_same_v<One, verb::Contact> || std::is_same_v<One, verb::Blow>) {
      return accept_lasting(one, due, chunk) && rings_alone();
    } else if constexpr (std::is_same_v<One, verb::Pickup>) {
      part(object, chunk.begin);
      if (!forces_->pickups.set(one, due.event.frame, object.pickups, object.voices)) count(counters_.refused);
      return false;
    } else if constexpr (One::kEffect == Effect::excites) {
      return true;
    } else {
      static_assert(One::kEffect != Effect::begins, "a verb that begins something is accepted here");
      if constexpr (kEndsContacts<One>) object.exciters.stop_at(due.event.frame);
      return !is_placing(One::kEffect) && rings_alone();
    }
  };
  return visit_now(begins, due.event.verb);
}

template <class Lasting>
bool Stage::accept_lasting(const Lasting& force, const DueEvent& due, const Chunk& chunk) REALTIME {
  Object& object = *due.object;
  if (is_sane(force)) {
    return forces_->exciters.open(force, due.event.frame, chunk.sample_rate_hz, object.voices.current(),
                                  object.exciters);
  }
  count(counters_.refused);
  return false;
}

// A mallet for which there is no place or time becomes a strike, and a rub a one-way contact, which it then stays; a
// bow or a coupling is refused.
Stage::Felt Stage::accept_touch(const Touch& how, const DueEvent& due, const Chunk& chunk,
                                const Shedding& shedding) REALTIME {
  Object& object = *due.object;
  const bool rubs = how.kind == Touch::Kind::rub;
  Object* const other = objects_.find(how.other);
  const bool one_way = rubs && object.exciters.find_contact(how.number, due.event.frame);
  Touches::Answer answer = Touches::Answer::refused;
  if (!rubs || is_sane(how.contact))
    answer = forces_->touches.accept(how, due.event.frame, object, other, one_way || shedding.tight());
  if (rubs && (answer == Touches::Answer::one_way || answer == Touches::Answer::nothing)) return Felt::one_way;
  if (answer == Touches::Answer::nothing) return Felt::not_at_all;
  if (answer == Touches::Answer::one_way && how.kind == Touch::Kind::mallet) return Felt::as_strike;
  if (answer != Touches::Answer::taken) {
    count(counters_.refused);
    return Felt::not_at_all;
  }
  for (Object* one : {&object, other}) {
    if (!one) continue;
    part(*one, chunk.begin);
    active_objects_.add(*one);
  }
  return Felt::taken;
}

template <class Strike>
bool Stage::starts_pulse(const Strike& strike, const DueEvent& due, const Chunk& chunk) REALTIME {
  Object& object = *due.object;
  if (!forces_->exciters.start_pulse(strike, due.event.frame, chunk.sample_rate_hz, object.voices.current(),
                                     object.exciters)) {
    return false;
  }
  part(object, chunk.begin);
  active_objects_.add(object);
  count(counters_.strikes);
  return true;
}

// Returns true if a silent object may share its states from the beginning of the chunk on. First updates the gains by
// which it is heard.
bool Stage::settles(Object& object, const Chunk& chunk) REALTIME {
  if (!object.placement.heard(chunk)) return true;
  if (object.active) return false;
  object.placement.begin_chunk(chunk, object.voices, object.strip);
  return object.placement.begun(chunk) && object.placement.may_share(chunk, *object.voices.current());
}

// Members of groups that are heard differently now ring alone again, unless they have fallen by 60 dB since they were
// struck. A part of the objects is looked at in each chunk.
void Stage::part_drifted(const Chunk& chunk) REALTIME {
  constexpr std::size_t kTurns = 8;
  next_looked_at_ = (next_looked_at_ + 1) % kTurns;
  for (std::size_t i = next_looked_at_; i < object_limit_; i += kTurns) {
    Object* const found = objects_.find(i);
    if (!found || !found->member.shares_states) continue;
    Object& object = *found;
    const Voice& voice = *object.voices.current();
    const auto since = static_cast<double>(chunk.begin - object.member.anchor);
    if (since > 3 * voice.table().whole().ring_s * chunk.sample_rate_hz) continue;
    if (object.placement.drifted(chunk, voice, 1)) part(object, chunk.begin);
  }
}

// Strikes on objects that share their states go to their group. An object that is struck begins to share if it can.
void Stage::give_to_source(DueEvent& due, const Chunk& chunk, const Shedding& shedding, Workspace& workspace) REALTIME {
  Object& object = *due.object;
  if (object.member.shares_states && chunk.listening &&
      object.placement.drifted(chunk, *object.voices.current(), kStruckDrift)) {
    part(object, chunk.begin);
    object.placement.begin_anew();
  }
  if (!object.due.first && !object.member.shares_states && !object.touched && excites(due.event) &&
      object.left_group != chunk.begin && object.can_share(chunk.begin) && shedding.may_join(object.units_to_share()) &&
      settles(object, chunk)) {
    join(object, chunk.begin, shedding, workspace);
  }
  if (object.member.shares_states) {
    InstanceGroup& group = *object.voices.current()->table().instances;
    group.due.append(due);
    active_groups_.add(group);
  } else {
    object.due.append(due);
    active_objects_.add(object);
  }
}

std::span<Source* const> Stage::sources() REALTIME {
  std::size_t count = 0;
  for (InstanceGroup* group : active_groups_.all()) sources_[count++] = group;
  if (object_limit_ > 0) {
    for (TouchGroup* group : forces_->touches.groups()) sources_[count++] = group;
  }
  for (Object* object : active_objects_.all()) {
    if (!object->touched) sources_[count++] = object;
  }
  return {sources_.data(), count};
}

void Stage::join(Object& object, Frame now, const Shedding& shedding, Workspace& workspace) REALTIME {
  InstanceGroup& group = *object.voices.current()->table().instances;
  if (!group.join(object, now)) return;
  shedding.worked(object.units_to_share(), workspace);
  active_groups_.add(group);
}

// The object rings alone from frame `now` on.
void Stage::part(Object& object, Frame now) REALTIME {
  object.left_group = now;
  if (!object.member.shares_states) return;
  object.voices.current()->table().instances->leave(object, now);
  active_objects_.add(object);
}

// Events for which there was no time happen in the next chunk.
void Stage::put_back(DueList& due) REALTIME {
  for (; due.first; due.first = due.first->next) {
    EventQueue::Pending pending = due.first->queued;
    pending.travelled = true;
    events_.put_back(pending);
    due.first->waits = true;
    events_waited_ = true;
  }
}

void Stage::finish_chunk(const Chunk& chunk, const Shedding& shedding, Workspace& workspace) REALTIME {
  // Silent groups leave their list before a voice whose table holds one can be retired.
  active_groups_.keep_if([&](InstanceGroup& group) REALTIME {
    put_back(group.due);
    if (!group.ringing()) group.end_round();
    return group.ringing();
  });
  active_objects_.keep_if([&](Object& object) REALTIME {
    const bool waits = object.due.first != nullptr;  // and would leave its group again
    put_back(object.due);
    if (!stays_active(object, chunk)) return false;
    if (waits || object.member.shares_states || !object.can_share(chunk.end()) ||
        !object.placement.may_share(chunk, *object.voices.current()) || !shedding.may_join(object.units_to_share())) {
      return true;
    }
    join(object, chunk.end(), shedding, workspace);
    return false;
  });
  if (forces_) forces_->pickups.drop_finished(chunk.end());
  for (std::size_t i = 0; i < due_count_; ++i) {
    const DueEvent& due = due_[i];
    if (!due.waits) events_.release(due.queued.event);
  }
  due_count_ = 0;
}

bool Stage::stays_active(Object& object, const Chunk& chunk) REALTIME {
  const bool had_tails = object.voices.has_tails();
  const bool pulse = object.voices.current() && object.exciters.has_pulse();
  object.voices.drop_silent_tails([&](Voice* voice, bool last) REALTIME {
    if (last) {  // before the worker learns that the number is free again
      object.strip.reset(), object.placement.forget(), object.fan.forget();
      forces_->pickups.leave(object.pickups);
    }
    voices_.retire(object.number, voice);
  });
  const bool stays = object.ringing() || object.touched || (pulse && !had_tails);
  forces_->exciters.drop_finished(chunk.end(), object.exciters);
  return stays;
}

void Stage::start_click(const verb::Click& click, const DueEvent& due, const Chunk& chunk,
                        const Shedding& shedding) REALTIME {
  const Voice* const voice = due.object->voices.current();
  const double impulse_ns = length(click.impulse_ns);
  const std::optional<ClickShape> shape = voice ? voice->table().click : std::nullopt;
  const bool sane =
      impulse_ns <= kMaxClickImpulse_ns && click.contact_time_s >= 0 && click.contact_time_s <= kMaxClick_s;
  if (shedding.tight() && sane) return;
  if (!shape || !sane ||
      !clicks_.add(
          {{*shape, impulse_ns, click.contact_time_s, chunk.sample_rate_hz}, due.object->number, due.event.frame})) {
    count(counters_.refused);
  }
}

// Clicks are few and soon over: the audio thread renders them alone.
void Stage::render_clicks(const Chunk& chunk, Workspace& workspace) REALTIME {
  for (std::size_t i = 0; i < clicks_.size(); ++i) {
    Clicks::One& one = clicks_[i];
    const auto begin = static_cast<std::size_t>(std::max<Frame>(one.begin - chunk.begin, 0));
    one.click.fill(chunk.frames - begin, workspace.mono.data() + begin);
    Object& struck = *objects_.find(one.object);
    if (!struck.placement.begun(chunk) && !struck.member.shares_states) {
      struck.placement.begin_chunk(chunk, struck.voices, struck.strip);
      struck.placement.end_chunk(chunk, struck.voices);
    }
    if (are_sane({workspace.mono.data() + begin, chunk.frames - begin})) {
      struck.strip.add_samples(workspace.mono.data(), begin, chunk.frames, chunk, workspace.sums);
    } else {
      count(chunk.counters->not_finite);
    }
  }
  clicks_.drop_before(chunk.end());
}

void Stage::part_all(Frame now) {
  for (const std::unique_ptr<Object>& object : objects_.all()) part(*object, now);
  clicks_.clear();
  active_groups_.keep_if([](InstanceGroup& group) {
    if (!group.ringing()) group.end_round();
    return group.ringing();
  });
}

}  // namespace ringdown::synth
