#include "engine/synth/mixer.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace ringdown::synth {

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
  crew_ = std::make_unique<Crew>(
      threads - 1, [this](std::size_t item, std::size_t who) RINGDOWN_REALTIME { visit(item, places_.data()[who]); });
}

bool Mixer::install(ObjectNumber object, std::unique_ptr<Voice> voice, Install how, Frame at) {
  assert(object < kMaxObjects && voice);
  if (voices_alive_ == kMaxVoices) return false;
  const auto kind = how == Install::replace ? Order::Kind::replace : Order::Kind::retune;
  found_family(object, voice->shared_table());
  if (!orders_.push({.kind = kind, .object = object, .at = at, .voice = voice.get()})) return false;
  static_cast<void>(voice.release());
  ++voices_alive_;
  ++voices_of_[object];
  return true;
}

bool Mixer::remove(ObjectNumber object) {
  assert(object < kMaxObjects);
  return orders_.push({.kind = Order::Kind::remove, .object = object});
}

bool Mixer::assign(ObjectNumber object, std::optional<std::size_t> bus) {
  assert(object < kMaxObjects && (!bus || *bus < kMaxBuses));
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
  Peaks written;
  Place& place = places_.data()[0];
  place.ringing_voices = place.ringing_modes = place.hidden_modes = 0;
  for (std::size_t done = 0; done < frames;) {
    for (std::size_t i = 0; i < kMaxInputs; ++i) inputs_[i] = inputs[i] ? inputs[i] + done : nullptr;
    accept_orders(now_);
    std::size_t chunk = wake_inputs(frames - done);
    if (const Order* const next = orders_.front()) chunk = std::min(chunk, static_cast<std::size_t>(next->at - now_));
    const Frame rest = static_cast<Frame>(chunk);
    if (active_count_ + active_family_count_ + clicks_.size() == 0 && !agenda_.next_before(now_ + rest)) {
      budget_.open_chunk(chunk, 0);
      place.desk.open(chunk);
    } else {
      chunk = std::min(kChunkFrames, chunk);
      budget_.open_chunk(chunk, (active_family_count_ + active_count_) / places_.size());
      render_chunk(chunk);
    }
    write(heard, done, chunk, written);
    done += chunk;
    now_ += static_cast<Frame>(chunk);
    if (watch_objects_.load(std::memory_order_relaxed)) measure_objects();
    if (mode_watch_.watches()) measure_modes();
  }
  const float peak = finish_mix(heard, frames, written);
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
  const std::size_t items = active_family_count_ + active_count_;
  sample_ = sample_ + 1 < items ? sample_ + 1 : 0;
  if (crew_ && much) {
    crew_->run(items);
  } else {
    for (std::size_t i = 0; i < items; ++i) visit(i, places_.data()[0]);
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

// Number `item` of the active families, then objects. One that had nothing to do, though there was time, tells what it
// costs to come by.
void Mixer::visit(std::size_t item, Place& place) RINGDOWN_REALTIME {
  if (item != sample_ || &place != places_.data()) return render_item(item, place);
  const std::int64_t begin_ns = budget_.begin();
  const double units = place.units;
  const bool missed = std::exchange(place.missed, false);
  render_item(item, place);
  if (place.units == units && !place.missed) budget_.visited(begin_ns);
  place.missed = place.missed || missed;
}

// And what remains to be done about it.
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
  ObjectNumber* const active = active_.data();
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
    assert(handed_over);  // the ring holds kMaxVoices, and install() allows no more
  }
}

void Mixer::reset(Object& object) RINGDOWN_REALTIME {
  object.bus = kNoBus;
  object.gain = {1, 1};
  object.left = object.right = {kCentre, kCentre};
}

ObjectNumber Mixer::number_of(const Object& object) const RINGDOWN_REALTIME {
  return static_cast<ObjectNumber>(&object - objects_.data());
}

}  // namespace ringdown::synth
