// The mixer's half of family.h: who shares states, and since when.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <utility>

namespace ringdown::synth {

namespace {

constexpr double kMaxSharedGain = 100;

}  // namespace

// With the second voice of a table; it lives as long as the table.
void Mixer::found_family(ObjectNumber object, const std::shared_ptr<ModeTable>& table) {
  const auto known = std::ranges::find_if(families_, [&](const Kin& kin) { return kin.table.lock() == table; });
  if (known == families_.end()) {
    families_.push_back({table, nullptr});
  } else if (!known->family) {
    auto family = std::make_unique<Family>(*table);
    const Order order{.kind = Order::Kind::found_family, .object = object, .family = family.get()};
    if (orders_.push(order)) known->family = std::move(family);
  }
}

std::shared_ptr<ModeTable> Mixer::table_for(const std::shared_ptr<const modal::StrikeMap>& map,
                                            const modal::MaterialScale& material, const modal::Dampers& dampers,
                                            modal::ModeRange modes) const {
  for (const Kin& kin : families_) {
    if (auto table = kin.table.lock(); table && table->is_of(map, material, dampers, modes)) return table;
  }
  return std::make_shared<ModeTable>(map, material, sample_rate_hz(), dampers, modes);
}

bool Mixer::can_share(const Object& object, Frame now) RINGDOWN_REALTIME {
  if (!object.current || object.tails || object.drive_count > 0 || object.current->fading()) return false;
  const Family* family = object.current->table().family;
  // Gains are part of the sums, and what is absurdly loud (Ringing::kAbsurdEnergy) should not depend on sharing.
  if (std::abs(object.gain.to) > kMaxSharedGain) return false;
  return family && (family->members == 0 || family->bus == object.bus) && still(object, now);
}

// From frame `now` on, which its states have reached.
void Mixer::share(Object& object, Frame now) RINGDOWN_REALTIME {
  Family& family = *object.current->table().family;
  const double gain = object.gain.to;
  object.shared = true;
  object.shares = {gain * object.left.to, gain * object.right.to, object.bus == kNoBus ? 0.0 : gain};
  object.anchor = now;
  object.lost = family.lost;
  family.bus = object.bus;
  ++family.members;
  if (!object.current->ringing()) return;
  family.add(*object.current, object.shares);
  count_work(units_to_share(object), places_.data()[0]);
  object.current->rest();
  note_struck(object, family);
  activate(family);
}

void Mixer::note_struck(Object& object, Family& family) RINGDOWN_REALTIME {
  if (std::exchange(object.round, family.round) != family.round) ++family.struck;
}

// Moves the states it keeps for itself on to frame `now`.
void Mixer::catch_up(Object& object, Frame now) RINGDOWN_REALTIME {
  const Family& family = *object.current->table().family;
  if (std::exchange(object.lost, family.lost) != family.lost) object.current->silence();
  object.current->skip(now - std::exchange(object.anchor, now));
}

// Rings alone from the present frame on.
void Mixer::part(Object& object) RINGDOWN_REALTIME {
  object.parted = now_;
  if (!std::exchange(object.shared, false)) return;
  Family& family = *object.current->table().family;
  catch_up(object, now_);
  const auto& [left, right, bus] = object.shares;
  if (family.active) family.add(*object.current, {-left, -right, -bus});
  count_work(units_to_share(object), places_.data()[0]);
  if (std::exchange(object.round, 0) == family.round) --family.struck;
  if (--family.members == 0) family.silence();
  object.current->wake();
  activate(object);
}

void Mixer::activate(Family& family) RINGDOWN_REALTIME {
  if (std::exchange(family.active, true)) return;
  active_families_.data()[active_family_count_++] = &family;
}

// Takes silent families off the list, before a voice whose table holds one can be retired.
void Mixer::keep_active_families() RINGDOWN_REALTIME {
  Family** const active = active_families_.data();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < active_family_count_; ++i) {
    Family& family = *active[i];
    put_back(family.first_due);
    if (family.ringing()) {
      active[kept++] = &family;
    } else {
      family.active = false;
      family.struck = 0;
      ++family.round;
    }
  }
  active_family_count_ = kept;
}

void Mixer::render_family(Family& family, bool in_turn, Place& place) RINGDOWN_REALTIME {
  const DueEvent* const due = due_.data();
  std::int32_t& next = family.first_due;
  std::size_t at = 0;
  bool struck_aside = false;
  const auto strikes_wait = [&]() RINGDOWN_REALTIME { return must_wait(due[next].event, place); };
  if (next >= 0) attend(family);
  for (; next >= 0 && due[next].offset == 0 && !strikes_wait(); next = due[next].next) {
    static_cast<void>(strike(family, due[next].event, 0));
  }
  listen(family, in_turn, place);
  if (together_) render_together(family, place);
  for (; next >= 0 && !strikes_wait(); next = due[next].next) {
    if (!together_) render_segment(family, at, due[next].offset, place);
    if (struck_aside) render_aside(family, at, due[next].offset, place);
    at = due[next].offset;
    const std::size_t left = together_ ? frames_ - at : 0;
    struck_aside = (strike(family, due[next].event, left) && together_) || struck_aside;
  }
  if (!together_) render_segment(family, at, frames_, place);
  if (struck_aside) render_aside(family, at, frames_, place);
  for_outputs(family, [&](Ringing& sum, std::size_t) RINGDOWN_REALTIME {
    if (struck_aside) sum.join();
    count_work(units_of(sum.sounding_modes()), place);
    place.hidden_modes += static_cast<std::uint32_t>(sum.hidden_modes());
    place.ringing_modes += static_cast<std::uint32_t>(sum.sounding_modes());
    place.slow_modes += sum.sounding_slow_modes();
  });
  place.ringing_voices += static_cast<std::uint32_t>(family.struck);
}

// Strikes one of its objects: aside, so many frames before the end of the chunk, or with 0 at once.
bool Mixer::strike(Family& family, const Event& event, std::size_t left) RINGDOWN_REALTIME {
  Object& object = objects_.data()[event.object];
  Voice& voice = *object.current;
  const std::optional<double> energy = voice.find_amplitudes(event);
  if (!energy || !(*energy <= Ringing::kAbsurdEnergy)) {
    count(energy ? counters_.not_finite : counters_.refused);
    return false;
  }
  catch_up(object, event.frame);
  voice.add(voice.amplitudes(), 1);
  voice.rest();
  for (std::size_t i = 0; i < Family::kOutputs; ++i) {
    if (object.shares[i] == 0) continue;
    if (left > 0) {
      family.sums[i].add_aside(voice.amplitudes(), object.shares[i], left);
    } else {
      family.sums[i].add(voice.amplitudes(), object.shares[i]);
    }
  }
  note_struck(object, family);
  count(counters_.strikes);
  return true;
}

void Mixer::render_together(Family& family, Place& place) RINGDOWN_REALTIME {
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    if (!sum.ringing()) return;
    const bool wanted = contains(wanted_, channel);
    const MomentTarget target{wanted ? place.desk.moments(channel) : nullptr, 1.0f};
    double* const rest = wanted && sum.has_rest() ? place.desk.samples(channel) : place.mono.data();
    keep_if(sum.render_together({&target, wanted ? std::size_t{1} : 0}, rest, frames_,
                                floor_.load(std::memory_order_relaxed)),
            family);
  });
}

void Mixer::render_segment(Family& family, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME {
  if (begin == end) return;
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    if (!sum.ringing()) return;
    double* const out = contains(wanted_, channel) ? place.desk.samples(channel) : place.mono.data();
    keep_if(sum.render(out + begin, end - begin, floor_.load(std::memory_order_relaxed)), family);
  });
}

void Mixer::render_aside(Family& family, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME {
  if (begin == end) return;
  for_outputs(family, [&](Ringing& sum, std::size_t channel) RINGDOWN_REALTIME {
    double* const out = contains(wanted_, channel) ? place.desk.samples(channel) : place.mono.data();
    keep_if(sum.render_aside(out + begin, end - begin), family);
  });
}

// A sum that was no longer sensible has been silenced: what its objects keep for themselves goes too.
void Mixer::keep_if(bool sane, Family& family) RINGDOWN_REALTIME {
  if (sane) return;
  family.silence();
  ++family.lost;
  count(counters_.not_finite);
}

}  // namespace ringdown::synth
