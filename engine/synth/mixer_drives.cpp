// The mixer's half of drives.h: pulses and inputs that act on objects.
#include "engine/synth/mixer.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

namespace ringdown::synth {

namespace {

constexpr double kMaxClickImpulse_ns = 1e9, kMaxClick_s = 1;

}  // namespace

bool Mixer::connect_input(std::size_t input, const Event& place) {
  assert(input < kMaxInputs && place.object < kMaxObjects);
  return orders_.push({.kind = Order::Kind::connect, .object = place.object, .input = input, .place = place});
}

bool Mixer::disconnect_input(std::size_t input) {
  assert(input < kMaxInputs);
  return orders_.push({.kind = Order::Kind::disconnect, .object = 0, .input = input});
}

// False when the strike is better shaped by its spectrum, or there is no time for more.
bool Mixer::start_pulse(const Event& event) RINGDOWN_REALTIME {
  if (!exact_contacts_.load(std::memory_order_relaxed) || tight_) return false;
  Object& object = objects_.data()[event.object];
  const double frames = event.contact_time_s * sample_rate_hz_;
  if (!object.current || !(frames >= kMinPulse_frames) || object.drive_count == kMaxForces) return false;
  const std::optional<std::uint8_t> taken = drives_.take();
  if (!taken) return false;
  Drive& drive = drives_[*taken];
  drive.place = event;
  drive.place.contact_time_s = 0;
  drive.input.reset();
  drive.contact.reset();
  drive.pulse = HalfSine(frames);
  drive.end = std::numeric_limits<Frame>::max();
  if (!place_drive(object, *taken)) {
    drives_.give_back(*taken);
    return false;
  }
  part(object);
  activate(object);
  count(counters_.strikes);
  return true;
}

Drive* Mixer::find_contact(const Object& object, std::uint32_t number) RINGDOWN_REALTIME {
  for (std::size_t i = 0; i < object.drive_count; ++i) {
    Drive& drive = drives_[object.drives[i]];
    if (drive.contact == number && !drive.input) return &drive;
  }
  return nullptr;
}

// Makes room for a contact that is new. False when there is nothing to tell of it, or no room.
bool Mixer::open_contact(const Event& event) RINGDOWN_REALTIME {
  const Contact& contact = event.contact;
  Object& object = objects_.data()[event.object];
  if (find_contact(object, contact.number)) return true;
  const double force = length(contact.force_n);
  if (force == 0) return false;
  const std::optional<std::uint8_t> taken =
      object.current && object.drive_count < kMaxForces ? drives_.take() : std::nullopt;
  if (!taken) {
    count(counters_.refused);
    return false;
  }
  Drive& drive = drives_[*taken];
  drive.place = place_of(event);
  drive.input.reset();
  drive.contact = contact.number;
  drive.rubbing = Rubbing(contact.number, sample_rate_hz_);
  drive.end = std::numeric_limits<Frame>::max();
  if (place_drive(object, *taken)) return true;
  drives_.give_back(*taken);
  count(counters_.refused);
  return false;
}

// An impulse of 1 along the force.
Event Mixer::place_of(const Event& event) RINGDOWN_REALTIME {
  Event place{.frame = event.frame, .object = event.object, .point_m = event.point_m};
  place.impulse_ns = (1 / length(event.contact.force_n)) * event.contact.force_n;
  return place;
}

// The contact is as the event says from its frame on.
void Mixer::tell(Object& object, const Event& event) RINGDOWN_REALTIME {
  Drive* const drive = find_contact(object, event.contact.number);
  if (!drive) return;
  drive->rubbing.tell(event.frame, event.contact);
  if (length(event.contact.force_n) == 0 || !object.current) return;
  drive->place = place_of(event);
  const std::optional<double> energy = object.current->find_amplitudes(drive->place);
  if (!energy || !(*energy <= Ringing::kAbsurdEnergy)) return;
  std::copy_n(object.current->amplitudes(), object.current->table().columns(), drive->amplitudes.get());
}

void Mixer::stop_pulses(const Object& object, Frame end) RINGDOWN_REALTIME {
  for (std::size_t i = 0; i < object.drive_count; ++i) {
    Drive& drive = drives_[object.drives[i]];
    drive.end = std::min(drive.end, end);
  }
}

void Mixer::connect(const Order& order) RINGDOWN_REALTIME {
  disconnect(order.input);
  Object& object = objects_.data()[order.object];
  if (!object.current) return;
  if (object.drive_count == kMaxForces) drop_pulse(object);
  const std::optional<std::uint8_t> taken = drives_.take();
  if (!taken) return count(counters_.refused);
  drives_[*taken].place = order.place;
  drives_[*taken].place.contact_time_s = 0;
  drives_[*taken].input = order.input;
  drives_[*taken].contact.reset();
  if (place_drive(object, *taken)) {
    excites_[order.input] = order.object;
  } else {
    drives_.give_back(*taken);
  }
}

// An input comes to stay; a pulse or contact would soon have ended.
void Mixer::drop_pulse(Object& object) RINGDOWN_REALTIME {
  for (std::size_t i = 0; i < object.drive_count; ++i) {
    if (!drives_[object.drives[i]].input) return drop_drive(object, i);
  }
}

void Mixer::disconnect(std::size_t input) RINGDOWN_REALTIME {
  if (!excites_[input]) return;
  Object& object = objects_.data()[*excites_[input]];
  for (std::size_t i = 0; i < object.drive_count; ++i) {
    if (drives_[object.drives[i]].input != input) continue;
    drop_drive(object, i);
    return;
  }
}

// Finds what the drive does to the object's modes, and adds it to the object. False when it cannot be.
bool Mixer::place_drive(Object& object, std::uint8_t which) RINGDOWN_REALTIME {
  Drive& drive = drives_[which];
  Voice* const voice = object.current;
  if (!voice || voice->table().columns() > kMaxDrivenColumns) return false;
  const std::optional<double> energy = voice->find_amplitudes(drive.place);
  if (!energy || !(*energy <= Ringing::kAbsurdEnergy)) return false;
  std::copy_n(voice->amplitudes(), voice->table().columns(), drive.amplitudes.get());
  object.drives[object.drive_count++] = which;
  return true;
}

// After the object's voice has changed.
void Mixer::place_drives_again(Object& object) RINGDOWN_REALTIME {
  const auto before = object.drives;
  const std::size_t count = std::exchange(object.drive_count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (place_drive(object, before[i])) continue;
    object.drives[object.drive_count++] = before[i];
    drop_drive(object, object.drive_count - 1);
  }
}

void Mixer::drop_drive(Object& object, std::size_t which) RINGDOWN_REALTIME {
  const std::uint8_t drive = object.drives[which];
  if (drives_[drive].input) excites_[*drives_[drive].input].reset();
  object.drives[which] = object.drives[--object.drive_count];
  drives_.give_back(drive);
}

// Gives back the pulses that are over.
void Mixer::keep_drives(Object& object, Frame end) RINGDOWN_REALTIME {
  for (std::size_t i = 0; i < object.drive_count;) {
    if (drives_[object.drives[i]].over_at(end)) {
      drop_drive(object, i);
    } else {
      ++i;
    }
  }
}

bool Mixer::has_pulse(const Object& object) const RINGDOWN_REALTIME {
  return std::any_of(object.drives.begin(), object.drives.begin() + object.drive_count,
                     [this](std::uint8_t drive) RINGDOWN_REALTIME { return !drives_[drive].input; });
}

// Whether a force acts on it in this chunk.
bool Mixer::driven(const Object& object) const RINGDOWN_REALTIME {
  return std::any_of(object.drives.begin(), object.drives.begin() + object.drive_count,
                     [this](std::uint8_t drive) RINGDOWN_REALTIME {
                       const std::optional<std::size_t>& input = drives_[drive].input;
                       return !input || input_sounds_[*input];
                     });
}

// Objects whose input is not silent take part in a chunk of `frames`, or less when there is input at all.
std::size_t Mixer::wake_inputs(std::size_t frames) RINGDOWN_REALTIME {
  for (std::size_t input = 0; input < kMaxInputs; ++input) {
    const float* const samples = inputs_[input];
    input_sounds_[input] = false;
    if (!samples || !excites_[input]) continue;
    frames = std::min(frames, kChunkFrames);
    input_sounds_[input] = std::any_of(samples, samples + frames, [](float x) RINGDOWN_REALTIME { return x != 0; });
    if (input_sounds_[input]) activate(objects_.data()[*excites_[input]]);
  }
  return frames;
}

void Mixer::start_click(const Event& event) RINGDOWN_REALTIME {
  const Object& object = objects_.data()[event.object];
  const double impulse_ns = length(event.impulse_ns);
  const std::optional<ClickShape> shape = object.current ? object.current->table().click() : std::nullopt;
  const bool sane =
      impulse_ns <= kMaxClickImpulse_ns && event.contact_time_s >= 0 && event.contact_time_s <= kMaxClick_s;
  if (tight_ && sane) return;
  if (!shape || !sane ||
      !clicks_.add({{*shape, impulse_ns, event.contact_time_s, sample_rate_hz_}, event.object, event.frame})) {
    count(counters_.refused);
  }
}

// Few at a time and soon over: the audio thread does them by itself.
void Mixer::render_clicks() RINGDOWN_REALTIME {
  Place& place = places_.data()[0];
  for (std::size_t i = 0; i < clicks_.size(); ++i) {
    Clicks::One& one = clicks_[i];
    const auto begin = static_cast<std::size_t>(std::max<Frame>(one.begin - now_, 0));
    one.click.fill(frames_ - begin, place.mono.data() + begin);
    mix_segment(objects_.data()[one.object], begin, frames_, place);
  }
  clicks_.drop_if([](const Clicks::One& one) RINGDOWN_REALTIME { return one.click.over(); });
}

void Mixer::drive(Object& object, std::size_t begin, std::size_t end, Place& place) RINGDOWN_REALTIME {
  if (begin == end) return;
  std::array<Force, kMaxForces> forces;
  for (std::size_t i = 0; i < object.drive_count; ++i) {
    Drive& drive = drives_[object.drives[i]];
    const float* const samples = drive.input ? inputs_[*drive.input] : nullptr;
    double* const impulses = place.impulses[i].data();
    drive.fill(now_ + static_cast<Frame>(begin), end - begin, samples ? samples + begin : nullptr, impulses);
    forces[i] = {drive.amplitudes.get(), impulses};
  }
  const std::span<const Force> all(forces.data(), object.drive_count);
  count_work(units_to_drive(object, end - begin), place);
  if (!object.current->drive_aside(all, place.mono.data() + begin, end - begin)) count(counters_.not_finite);
}

}  // namespace ringdown::synth
