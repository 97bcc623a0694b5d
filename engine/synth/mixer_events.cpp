// What happens to objects: events are taken from the agenda, sorted to those they concern, and carried out.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {

namespace {

constexpr double kMinRamp_s = 0.005;  // a step in gain or pan would click
constexpr double kMaxRamp_s = 3600;
constexpr double kMaxValue = 1e6;  // of a gain or pan: what is beyond, or no number, would spoil the whole mix

bool is_sane(const Contact& contact) RINGDOWN_REALTIME {
  const Texture& t = contact.texture;
  const auto within = [](double value, double least, double most)
                          RINGDOWN_REALTIME { return value >= least && value <= most; };  // no number is in no range
  return within(dot(contact.force_n, contact.force_n), 0, kMaxValue * kMaxValue) &&
         within(contact.slip_m_s, 0, kMaxValue) && within(contact.roll_m_s, 0, kMaxValue) &&
         within(t.roughness_m, 0, 1) && within(t.correlation_m, 1e-9, 1e3) && within(t.spectral_slope, -10, 0);
}

}  // namespace

// Sorts the events of the coming chunk to their objects.
void Mixer::take_due_events(std::size_t frames) RINGDOWN_REALTIME {
  DueEvent* due = due_.data();
  put_off_ = false;
  event_units_ = 0;
  const Frame end = now_ + static_cast<Frame>(frames);
  std::int32_t count = 0;
  for (; count < static_cast<std::int32_t>(kMaxEventsPerChunk); ++count, agenda_.pop()) {
    const Agenda::Pending* const next = agenda_.next_before(end);
    if (!next || !can_afford(next->event)) break;
    const Event* const event = &next->event;
    due[count] = {*event, static_cast<std::size_t>(std::max<Frame>(event->frame - now_, 0)), -1, event->frame,
                  next->order};
    due[count].event.frame = std::max(event->frame, now_);  // it may have been left over from the chunk before
    if (is_strike(*event)) {
      if (start_pulse(due[count].event)) --count;
      continue;
    }
    if (event->type == EventType::click) {
      start_click(due[count--].event);
      continue;
    }
    if (event->type == EventType::ring) continue;
    Object& object = objects_.data()[event->object];
    if (event->type == EventType::contact && !(is_sane(event->contact) && open_contact(*event))) {
      if (!is_sane(event->contact)) this->count(counters_.refused);
      --count;
      continue;
    }
    part(object);
    if (event->type == EventType::clear) stop_pulses(object, due[count].event.frame);
  }
  link_due_events(count);
}

// Strikes on objects whose states are shared go to their family.
void Mixer::link_due_events(std::int32_t count) RINGDOWN_REALTIME {
  DueEvent* const due = due_.data();
  const auto append = [due](std::int32_t place, std::int32_t& first, std::int32_t& last) RINGDOWN_REALTIME {
    (first < 0 ? first : due[last].next) = place;
    last = place;
  };
  for (std::int32_t place = 0; place < count; ++place) {
    Object& object = objects_.data()[due[place].event.object];
    if (object.first_due < 0 && !object.shared && excites(due[place].event) && object.parted != now_ &&
        can_share(object, now_) && !budget_.over(units_to_share(object))) {
      share(object, now_);
    }
    if (object.shared) {
      Family& family = *object.current->table().family;
      append(place, family.first_due, family.last_due);
      activate(family);
    } else {
      append(place, object.first_due, object.last_due);
      activate(object);
    }
  }
}

// Events for which there was no time happen in the next chunk.
void Mixer::put_back(std::int32_t& first_due) RINGDOWN_REALTIME {
  for (; first_due >= 0; first_due = due_.data()[first_due].next) {
    const DueEvent& due = due_.data()[first_due];
    Agenda::Pending pending{due.event, due.order};
    pending.event.frame = due.frame;
    agenda_.put_back(pending);
    put_off_ = true;
  }
}

void Mixer::apply(Object& object, const Event& event) RINGDOWN_REALTIME {
  if (event.type == EventType::contact) return tell(object, event);
  if (!is_strike(event) && !(std::abs(event.value) <= kMaxValue)) {
    count(counters_.refused);
    return;
  }
  // Written so that a ramp that is no number becomes the shortest.
  const double ramp_s = std::min(event.ramp_s > kMinRamp_s ? event.ramp_s : kMinRamp_s, kMaxRamp_s);
  const auto ramp = static_cast<Frame>(ramp_s * sample_rate_hz());
  if (excites(event)) {
    const bool struck = object.current && object.current->strike(event);
    count(struck ? counters_.strikes : counters_.refused);
  } else if (event.type == EventType::gain) {
    object.gain.aim(event.value, event.frame, ramp);
  } else if (event.type == EventType::pan) {
    const double angle = 0.25 * std::numbers::pi * (1 + event.value);
    object.left.aim(std::cos(angle), event.frame, ramp);
    object.right.aim(std::sin(angle), event.frame, ramp);
  } else if (event.type == EventType::clear) {
    fade_out(object, static_cast<std::size_t>(ramp));
  }
}

// The current voice and the tails of earlier banks alike.
void Mixer::fade_out(Object& object, std::size_t frames) RINGDOWN_REALTIME {
  if (object.current) object.current->fade_out(frames);
  for (Voice* voice = object.tails; voice; voice = voice->next) voice->fade_out(frames);
}

}  // namespace ringdown::synth
