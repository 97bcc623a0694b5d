// The mixer's half of budget.h: what work costs, and what is left out or put off when time is short.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <limits>

namespace ringdown::synth {

namespace {

// Of a strike, on an object that shares states too; of joining or leaving a family; of a pulse for a whole chunk.
constexpr double kStrikePerMode = 9, kSharedStrikePerMode = 12, kSharePerMode = 1.5, kDrivePerMode = 6;

constexpr double kPlanned = 0.78;        // of a chunk's time: what modes may take
constexpr double kPlannedAll = 0.88;     // of a chunk's time: what modes and events may take together
constexpr double kTight = 0.72;          // of a chunk's time: from here on the mixer looks at what is loud
constexpr double kVeryTight = 0.97;      // the same, when something is shed already
constexpr double kEventsShare = 0.3;     // of a chunk's time: more events wait
constexpr double kComingShare = 0.12;    // of a chunk's time, for what comes back
constexpr double kMaxEventFrames = 0.7;  // of a chunk's time: more than that is not waited for
constexpr double kLight = 0.25;          // of a chunk's time: less is done even when time is over
constexpr double kForgetEvents = 0.98;

}  // namespace

// Of rendering so many modes for a chunk.
double Mixer::units_of(std::size_t modes) const RINGDOWN_REALTIME {
  const auto each = together_ ? 1.0 : static_cast<double>(frames_) / static_cast<double>(kFramesPerMode);
  return each * static_cast<double>(modes);
}

double Mixer::units_of(const Event& event) const RINGDOWN_REALTIME {
  const Object& object = objects_.data()[event.object];
  if (!object.current || event.type == EventType::click) return 0;
  const auto modes = static_cast<double>(object.current->table().columns());
  if (excites(event)) return (object.shared ? kSharedStrikePerMode : kStrikePerMode) * modes;
  return object.shared ? kSharePerMode * modes : 0.0;
}

double Mixer::units_to_share(const Object& object) RINGDOWN_REALTIME {
  return kSharePerMode * static_cast<double>(object.current->table().columns());
}

double Mixer::units_to_drive(const Object& object, std::size_t frames) const RINGDOWN_REALTIME {
  const double chunks = static_cast<double>(frames) / static_cast<double>(kChunkFrames);
  return kDrivePerMode * chunks * static_cast<double>(object.current->table().columns());
}

double Mixer::units_of_item(std::size_t item) const RINGDOWN_REALTIME {
  std::size_t modes = 0;
  if (item < active_family_count_) {
    for (const Ringing& sum : active_families_.data()[item]->sums) modes += sum.sounding_modes();
  } else {
    const Object& object = objects_.data()[active_.data()[item - active_family_count_]];
    if (object.current) modes += object.current->sounding_modes();
    for (const Voice* voice = object.tails; voice; voice = voice->next) modes += voice->sounding_modes();
  }
  return units_of(modes);
}

// Whether the event may happen in this chunk; the first one always may.
bool Mixer::can_afford(const Event& event) RINGDOWN_REALTIME {
  if (!budget_.limited()) return true;
  const double units = units_of(event);
  const bool first = event_units_ == 0;  // whatever it costs, or nothing would ever happen
  put_off_ = !first && units > 0 && event_units_ + units > kEventsShare * budget_.usual();
  if (!put_off_) event_units_ += units;
  return !put_off_;
}

// The same when its turn has come. What takes longer than a chunk happens at last, and late.
bool Mixer::must_wait(const Event& event, Place& place) const RINGDOWN_REALTIME {
  if (!budget_.limited()) return false;
  const double units = units_of(event);
  if (units > 0 && budget_.over(std::min(units, kMaxEventFrames * budget_.usual()))) return true;
  count_work(units, place);
  return false;
}

// Whether there is no time left for an item. Forces that act are not interrupted; and where there is little to do it
// was not ours that the time was lost, and leaving it out would not win it back.
bool Mixer::must_miss(std::size_t item) const RINGDOWN_REALTIME {
  if (!budget_.limited() || light_ || !budget_.over(units_of_item(item))) return false;
  return item < active_family_count_ || !driven(objects_.data()[active_.data()[item - active_family_count_]]);
}

// Its events wait, and its states move on when there is time for them.
void Mixer::miss(std::size_t item, Place& place) RINGDOWN_REALTIME {
  const auto skip = [&](Ringing& states) RINGDOWN_REALTIME {
    if (states.ringing()) states.miss(frames_), place.missed = true;
    place.hidden_modes += static_cast<std::uint32_t>(states.hidden_modes());
    place.ringing_modes += static_cast<std::uint32_t>(states.sounding_modes());
  };
  if (item < active_family_count_) {
    for_outputs(*active_families_.data()[item], [&](Ringing& sum, std::size_t) RINGDOWN_REALTIME { skip(sum); });
    return;
  }
  item -= active_family_count_;
  Object& object = objects_.data()[active_.data()[item]];
  if (object.current) skip(*object.current);
  for (Voice* voice = object.tails; voice; voice = voice->next) skip(*voice);
  after_.data()[item] = object.tails ? After::look_at_tails : After::keep;
}

// Hidden modes that may come back in this chunk.
std::size_t Mixer::most_coming() const RINGDOWN_REALTIME {
  if (!budget_.limited()) return std::numeric_limits<std::size_t>::max();
  return static_cast<std::size_t>(kComingShare * budget_.usual() / kComingPerMode);
}

// That may sound, beside the events.
double Mixer::most_modes() const RINGDOWN_REALTIME {
  const double fixed = together_ ? static_cast<double>(kMomentsFixed) : 0.0;
  const double planned = std::min(kPlanned * budget_.usual(), kPlannedAll * budget_.usual() - event_reserve_);
  return std::max(planned - fixed, 0.0) / units_of(1);
}

void Mixer::count_work(double units, Place& place) const RINGDOWN_REALTIME {
  place.units += units;
  budget_.worked(units);
}

void Mixer::close_budget() RINGDOWN_REALTIME {
  const Place& place = places_.data()[0];
  hidden_modes_ = place.hidden_modes;
  sounding_modes_ = place.ringing_modes;
  tight_ = light_ = false;
  if (!budget_.limited()) return;
  const double units = place.units + (together_ ? static_cast<double>(kMomentsFixed) : 0.0);
  event_reserve_ = std::max(event_units_, kForgetEvents * event_reserve_);
  const double tight = least_ > Cut::kNothing ? kVeryTight : kTight;
  tight_ = place.missed || units > tight * budget_.usual();
  if (place.missed || put_off_ || least_ > Cut::kNothing) count(counters_.shed);
  budget_.close_chunk(units);
  light_ = units < kLight * budget_.usual();
}

}  // namespace ringdown::synth
