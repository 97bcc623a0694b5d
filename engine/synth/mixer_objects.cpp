// One object's share of a chunk: what rings of it, its strikes, what drives it.
#include "engine/synth/mixer.h"

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::synth {

// Renders one object's share of the chunk.
void Mixer::render_object(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME {
  if ((together_ || !heard(object)) && plain_in_chunk(object)) {
    render_together(object, in_turn, place);
  } else {
    render_in_segments(object, in_turn, place);
  }
  const auto note = [this, &place](const Voice& voice) RINGDOWN_REALTIME {
    if (!voice.ringing()) return;
    count_work(units_of(voice.sounding_modes()), place);
    place.hidden_modes += static_cast<std::uint32_t>(voice.hidden_modes());
    ++place.ringing_voices;
    place.ringing_modes += static_cast<std::uint32_t>(voice.sounding_modes());
    place.slow_modes += voice.sounding_slow_modes();
  };
  if (object.current) note(*object.current);
  for (const Voice* voice = object.tails; voice; voice = voice->next) note(*voice);
}

// Nothing but strikes happens to it, and no gain or pan is moving.
bool Mixer::plain_in_chunk(const Object& object) const RINGDOWN_REALTIME {
  for (std::int32_t i = object.first_due; i >= 0; i = due_.data()[i].next) {
    if (!excites(due_.data()[i].event)) return false;
  }
  return still(object, now_);
}

bool Mixer::still(const Object& object, Frame at) RINGDOWN_REALTIME {
  return object.gain.still_at(at) && object.left.still_at(at) && object.right.still_at(at);
}

// What quieter modes may rest at, in units of their states. A force that acts may yet make them loud, little by little.
double Mixer::floor_of(const Object& object) const RINGDOWN_REALTIME {
  if (driven(object)) return 0;
  const double gain = std::max(std::abs(object.gain.from), std::abs(object.gain.to));
  return floor_.load(std::memory_order_relaxed) / std::max(1.0, gain);
}

void Mixer::render_in_segments(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME {
  std::size_t at = 0;
  bool has_listened = false;
  const auto render_to = [&](std::size_t end) RINGDOWN_REALTIME {
    if (end > at && !std::exchange(has_listened, true)) listen(object, in_turn, place);
    render_segment(object, at, end, place);
    at = end;
  };
  std::int32_t i = std::exchange(object.first_due, -1);
  if (i >= 0) attend(object);
  for (; i >= 0 && !must_wait(due_.data()[i].event, place); i = due_.data()[i].next) {
    render_to(due_.data()[i].offset);
    apply(object, due_.data()[i].event);
  }
  object.first_due = i;
  render_to(frames_);
}

// What rings already, as moments; strikes within the chunk beside it, sample by sample.
void Mixer::render_together(Object& object, bool in_turn, Place& place) RINGDOWN_REALTIME {
  if (object.first_due >= 0) attend(object);
  std::int32_t& next = object.first_due;
  for (; next >= 0 && due_.data()[next].offset == 0; next = due_.data()[next].next) {
    if (must_wait(due_.data()[next].event, place)) break;
    apply(object, due_.data()[next].event);
  }
  listen(object, in_turn, place);
  std::array<MomentTarget, 3> all;
  std::size_t count_of_targets = 0;
  const auto aim = [&](std::size_t channel, double gain) RINGDOWN_REALTIME {
    if (contains(wanted_, channel)) all[count_of_targets++] = {place.desk.moments(channel), static_cast<float>(gain)};
  };
  aim(kLeft, object.gain.to * object.left.to);
  aim(kRight, object.gain.to * object.right.to);
  if (object.bus != kNoBus) aim(object.bus, object.gain.to);
  const std::span<const MomentTarget> targets(all.data(), count_of_targets);
  bool sounds = next >= 0 || driven(object);
  const auto each_voice = [&object](const auto& act) RINGDOWN_REALTIME {
    if (object.current) act(*object.current);
    for (Voice* voice = object.tails; voice; voice = voice->next) act(*voice);
  };
  each_voice([&](const Voice& voice) RINGDOWN_REALTIME { sounds = sounds || voice.has_rest(); });
  if (sounds) std::fill_n(place.mono.data(), frames_, 0.0);
  each_voice([&](Voice& voice) RINGDOWN_REALTIME {
    if (!voice.ringing()) return;
    if (!voice.render_together(targets, place.mono.data(), frames_, floor_of(object))) count(counters_.not_finite);
  });
  if (next >= 0 || driven(object)) add_strikes(object, place);
  if (sounds) mix_segment(object, 0, frames_, place);
}

// The rest of a chunk's strikes, and what drives the object.
void Mixer::add_strikes(Object& object, Place& place) RINGDOWN_REALTIME {
  std::int32_t& due = object.first_due;
  Voice* const voice = object.current;
  const bool driven = this->driven(object);
  bool struck = driven;
  std::size_t at = 0;
  const auto render_to = [&](std::size_t end) RINGDOWN_REALTIME {
    if (driven) {
      drive(object, at, end, place);
    } else if (struck && end > at && !voice->render_aside(place.mono.data() + at, end - at))
      count(counters_.not_finite);
    at = end;
  };
  for (; due >= 0 && !must_wait(due_.data()[due].event, place); due = due_.data()[due].next) {
    render_to(due_.data()[due].offset);
    const bool played = voice && voice->strike_aside(due_.data()[due].event, frames_ - at);
    count(played ? counters_.strikes : counters_.refused);
    struck = struck || played;
  }
  render_to(frames_);
  if (struck) voice->join();
}

void Mixer::render_segment(Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME {
  if (begin == end) return;
  bool sounds = false;
  std::fill_n(place.mono.data() + begin, end - begin, 0.0);
  const auto add = [&](Voice* voice) RINGDOWN_REALTIME {
    if (!voice || !voice->ringing()) return;
    if (!voice->render(place.mono.data() + begin, end - begin, floor_of(object))) count(counters_.not_finite);
    sounds = true;
  };
  add(object.current);
  for (Voice* voice = object.tails; voice; voice = voice->next) add(voice);
  if (driven(object)) {
    drive(object, begin, end, place);
    object.current->join();
    sounds = true;
  }
  if (sounds) mix_segment(object, begin, end, place);
}

void Mixer::mix_segment(const Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME {
  const Frame first = now_ + static_cast<Frame>(begin);
  const Ramp unity{1, 1};
  const auto add_to = [&](std::size_t channel, const Ramp& share) RINGDOWN_REALTIME {
    if (!contains(wanted_, channel)) return;
    double* const out = place.desk.samples(channel);
    if (object.gain.still_at(first) && share.still_at(first)) {
      return add_scaled(place.mono.data() + begin, object.gain.to * share.to, out + begin, end - begin);
    }
    for (std::size_t n = begin; n < end; ++n) {
      const Frame frame = now_ + static_cast<Frame>(n);
      out[n] += object.gain.at(frame) * share.at(frame) * place.mono[n];
    }
  };
  add_to(kLeft, object.left);
  add_to(kRight, object.right);
  if (object.bus != kNoBus) add_to(object.bus, unity);
}

bool Mixer::heard(const Object& object) const RINGDOWN_REALTIME {
  return (wanted_ & (only(kLeft) | only(kRight) | (object.bus == kNoBus ? 0 : only(object.bus)))) != 0;
}

}  // namespace ringdown::synth
