#include "engine/synth/mixer.h"

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace ringdown::synth {

using protocol::Event;
using protocol::Frame;
Mixer::Mixer(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

Mixer::~Mixer() {
  for (; const Order* order = orders_.front(); orders_.pop()) delete order->voice;
  for (; const Retired* retired = retired_.front(); retired_.pop()) delete retired->voice;
  for (const Object& object : objects_) {
    delete object.current;
    for (Voice* voice = object.tails; voice;) delete std::exchange(voice, voice->next);
  }
}

void Mixer::limit(std::optional<double> ceiling_db) {
  ceiling_db_ = ceiling_db;
  limiter_.reset();
  if (ceiling_db) limiter_.emplace(sample_rate_hz_, *ceiling_db);
}

void Mixer::set_threads(std::size_t threads) {
  crew_.reset();
  places_ = std::vector<Place>(std::max<std::size_t>(1, threads));
  if (threads < 2) return;
  crew_ = std::make_unique<Crew>(threads - 1, [this](std::size_t item, std::size_t who)
                                                  RINGDOWN_REALTIME { render_item(item, places_.data()[who]); });
}

bool Mixer::install(protocol::ObjectNumber object, std::unique_ptr<Voice> voice, Install how, Frame at) {
  assert(object < kMostObjects && voice);
  if (voices_alive_ == kMostVoices) return false;
  const auto kind = how == Install::replace ? Order::Kind::replace : Order::Kind::retune;
  found_family(object, voice->shared_table());
  if (!orders_.push({.kind = kind, .object = object, .at = at, .voice = voice.get()})) return false;
  static_cast<void>(voice.release());
  ++voices_alive_;
  ++voices_of_[object];
  return true;
}

bool Mixer::remove(protocol::ObjectNumber object) {
  assert(object < kMostObjects);
  return orders_.push({.kind = Order::Kind::remove, .object = object});
}

bool Mixer::assign(protocol::ObjectNumber object, std::optional<std::size_t> bus) {
  assert(object < kMostObjects && (!bus || *bus < kMostBuses));
  return orders_.push({.kind = Order::Kind::assign, .object = object, .channel = bus ? kFirstBus + *bus : kNoBus});
}

void Mixer::collect() {
  for (; const Retired* retired = retired_.front(); retired_.pop()) {
    delete retired->voice;
    --voices_alive_;
    --voices_of_[retired->object];
  }
  std::erase_if(families_, [](const Kin& kin) { return kin.table.expired(); });
}

void Mixer::render(std::span<float> left, std::span<float> right) RINGDOWN_REALTIME {
  render(Outputs(left.data(), right.data()), left.size());
}

void Mixer::render(const Outputs& outputs, const Inputs& inputs, std::size_t frames) RINGDOWN_REALTIME {
  const DenormalGuard guard;
  budget_.open_block(frames, sample_rate_hz(), deadlines_);
  count(counters_.late, agenda_.accept(now_));
  const Outputs heard = with_tap(outputs, frames);
  wanted_ = heard.wanted();
  float peak = 0;
  Place& place = places_.data()[0];
  place.ringing_voices = place.ringing_modes = place.hidden_modes = 0;
  for (std::size_t done = 0; done < frames;) {
    for (std::size_t i = 0; i < kMostInputs; ++i) inputs_[i] = inputs[i] ? inputs[i] + done : nullptr;
    accept_orders(now_);
    std::size_t chunk = wake_inputs(frames - done);
    if (const Order* const next = orders_.front()) chunk = std::min(chunk, static_cast<std::size_t>(next->at - now_));
    const Frame rest = static_cast<Frame>(chunk);
    if (active_count_ + active_family_count_ + clicks_.size() == 0 && !agenda_.next_before(now_ + rest)) {
      budget_.open_chunk(chunk);
      place.desk.open(chunk);
    } else {
      chunk = std::min(kChunkFrames, chunk);
      budget_.open_chunk(chunk);
      render_chunk(chunk);
    }
    write(heard, done, chunk, peak);
    done += chunk;
    now_ += static_cast<Frame>(chunk);
    if (watch_objects_.load(std::memory_order_relaxed)) measure_objects();
    if (mode_watch_.watches()) measure_modes();
  }
  peak = finish_mix(heard, frames, peak);
  counters_.ringing_voices.store(place.ringing_voices, std::memory_order_relaxed);
  counters_.ringing_modes.store(place.ringing_modes, std::memory_order_relaxed);
  counters_.hidden_modes.store(place.hidden_modes, std::memory_order_relaxed);
  counters_.peak.store(peak, std::memory_order_relaxed);
  if (peak > counters_.peak_since.load(std::memory_order_relaxed)) {
    counters_.peak_since.store(peak, std::memory_order_relaxed);
  }
  counters_.frames.store(now_, std::memory_order_release);
}

void Mixer::accept_orders(Frame until) RINGDOWN_REALTIME {
  for (const Order* order = orders_.front(); order && order->at <= until; order = orders_.front()) {
    carry_out(*order);
    orders_.pop();
  }
}

void Mixer::carry_out(const Order& order) RINGDOWN_REALTIME {
  if (order.kind == Order::Kind::found_family) {
    order.family->table.family = order.family;
    return;
  }
  if (order.kind == Order::Kind::disconnect) return disconnect(order.input);
  numbers_ = std::max<std::size_t>(numbers_, order.object + 1);
  Object& object = objects_.data()[order.object];
  part(object);
  if (order.kind == Order::Kind::connect) return connect(order);
  if (order.kind == Order::Kind::assign) {
    object.bus = order.channel;
    return;
  }
  if (order.kind == Order::Kind::remove) fade_out(object, Voice::kFadeFrames);
  Voice* old = std::exchange(object.current, order.voice);
  place_drives_again(object);
  activate(object);  // the next chunk finds out what rings, and retires what does not
  if (!old) return;
  if (order.kind == Order::Kind::retune) {
    if (order.voice->take_over(*old)) {
      old->fade_out();
    } else {
      old->silence();
    }
  }
  keep_as_tail(object, old);
}

void Mixer::render_chunk(std::size_t frames) RINGDOWN_REALTIME {
  frames_ = frames;
  open_places(frames);
  take_due_events(frames);
  const bool much = choose_path(frames);
  prepare_tables(frames);
  survey(frames);
  if (crew_ && much) {
    crew_->run(active_family_count_ + active_count_);
  } else {
    for (std::size_t i = 0; i < active_family_count_ + active_count_; ++i) render_item(i, places_.data()[0]);
  }
  keep_active_families();
  keep_active();
  gather_places();
  render_clicks();
  places_.data()[0].desk.close();
  close_budget();
}

void Mixer::open_places(std::size_t frames) RINGDOWN_REALTIME {
  for (std::size_t who = 0; who < places_.size(); ++who) {
    Place& place = places_.data()[who];
    place.desk.open(frames);
    place.ringing_voices = place.ringing_modes = place.hidden_modes = 0;
    place.slow_modes = 0;
    place.units = 0;
    place.missed = false;
    place.most_coming = most_coming() / places_.size();
  }
}

// Into the audio thread's own.
void Mixer::gather_places() RINGDOWN_REALTIME {
  Place* const places = places_.data();
  slow_modes_ = places[0].slow_modes;
  for (std::size_t who = 1; who < places_.size(); ++who) {
    slow_modes_ += places[who].slow_modes;
    places[0].desk.take(places[who].desk);
    places[0].ringing_voices += places[who].ringing_voices;
    places[0].ringing_modes += places[who].ringing_modes;
    places[0].hidden_modes += places[who].hidden_modes;
    places[0].units += places[who].units;
    places[0].missed = places[0].missed || places[who].missed;
  }
}

// Before several threads read them.
void Mixer::prepare_tables(std::size_t frames) RINGDOWN_REALTIME {
  if (frames == kChunkFrames) return;
  for (std::size_t i = 0; i < active_family_count_; ++i) active_families_.data()[i]->table.prepare(frames);
  for (std::size_t i = 0; i < active_count_; ++i) {
    Object& object = objects_.data()[active_.data()[i]];
    if (object.current) object.current->table().prepare(frames);
    for (Voice* voice = object.tails; voice; voice = voice->next) voice->table().prepare(frames);
  }
}

// What rang in the last chunk decides. True when there is enough to do for several threads.
bool Mixer::choose_path(std::size_t frames) RINGDOWN_REALTIME {
  constexpr std::size_t kMuch = 3000;
  together_ = slow_modes_ * frames > kFramesPerMode * (kMomentsFixed + slow_modes_);
  return slow_modes_ > kMuch;
}

// Number `item` of the active families, then objects, and what remains to be done about it.
void Mixer::render_item(std::size_t item, Place& place) RINGDOWN_REALTIME {
  if (must_miss(item)) return miss(item, place);
  const bool in_turn = item >= survey_begin_ && item < survey_end_;
  if (item < active_family_count_) return render_family(*active_families_.data()[item], in_turn, place);
  item -= active_family_count_;
  Object& object = objects_.data()[active_.data()[item]];
  render_object(object, in_turn, place);
  const bool rings = object.current && (object.current->ringing() || has_pulse(object));
  after_.data()[item] = object.tails ? After::look_at_tails : rings ? After::keep : After::drop;
}

// Takes what no longer rings off the list of active objects.
void Mixer::keep_active() RINGDOWN_REALTIME {
  protocol::ObjectNumber* const active = active_.data();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < active_count_; ++i) {
    bool keep = after_.data()[i] == After::keep;
    Object& object = objects_.data()[active[i]];
    const bool waits = object.first_due >= 0;  // and would leave its family again
    put_back(object.first_due);
    if (after_.data()[i] == After::look_at_tails) {
      retire_silent_tails(object);
      keep = object.tails || (object.current && object.current->ringing());
    }
    const Frame end = now_ + static_cast<Frame>(frames_);
    keep_drives(object, end);
    if (keep && !waits && !object.shared && can_share(object, end) && !budget_.over(units_to_share(object))) {
      share(object, end);
      keep = false;
    }
    if (keep) {
      active[kept++] = active[i];
    } else {
      object.active = false;
    }
  }
  active_count_ = kept;
}

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

void Mixer::activate(Object& object) RINGDOWN_REALTIME {
  if (std::exchange(object.active, true)) return;
  active_.data()[active_count_++] = number_of(object);
}

void Mixer::keep_as_tail(Object& object, Voice* voice) RINGDOWN_REALTIME {
  voice->next = object.tails;
  object.tails = voice;
}

void Mixer::retire_silent_tails(Object& object) RINGDOWN_REALTIME {
  for (Voice** link = &object.tails; *link;) {
    Voice* voice = *link;
    Voice* next = voice->next;
    if (voice->ringing()) {
      link = &voice->next;
      continue;
    }
    const bool last = !object.current && !next && link == &object.tails;
    if (last) reset(object);  // before the worker learns that the number is free again
    *link = next;
    [[maybe_unused]] const bool handed_over = retired_.push({number_of(object), voice});
    assert(handed_over);  // the ring holds kMostVoices, and install() allows no more
  }
}

void Mixer::reset(Object& object) RINGDOWN_REALTIME {
  object.bus = kNoBus;
  object.gain = {1, 1};
  object.left = object.right = {kCentre, kCentre};
}

protocol::ObjectNumber Mixer::number_of(const Object& object) const RINGDOWN_REALTIME {
  return static_cast<protocol::ObjectNumber>(&object - objects_.data());
}

}  // namespace ringdown::synth
