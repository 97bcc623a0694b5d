#include "clients/plugin/keyboard.h"

#include "clients/plugin/mallets.h"

#include <algorithm>
#include <cmath>
#include <optional>

// libringdown's events allocate, lock and wait for nothing, but a C header cannot say so to the compiler.
TRUST_REALTIME_BEGIN

namespace ringdown::plugin {
namespace {

using session::HeldKeys;
namespace midi = session::midi;

constexpr double kHardnessOctaves = 3;        // a full controller 74 makes blows 8 times as short
constexpr double kMasterBend_semitones = 2;   // of MPE's master channels
constexpr double kMemberBend_semitones = 48;  // of the others, once a zone has been configured
constexpr std::size_t kLowerMaster = 0, kUpperMaster = midi::kChannels - 1;
constexpr std::uint8_t kBendRange = 0, kMpeConfiguration = 6;  // registered parameters
constexpr int kBendCentre = 8192;

// Time that a released key takes to be damped; nothing: it continues to ring.
std::optional<double> release_s(const Keyboard::Playing& playing) REALTIME {
  if (playing.map.is_note_map) return playing.map.release_s;
  const double time_s = playing.parameters[Parameter::release];
  return time_s < kRingsOn_s ? std::optional(time_s) : std::nullopt;
}

Bows::Moment moment_of(const Keyboard::Playing& playing) REALTIME {
  return {playing.mixer, playing.frame, playing.map.generation, playing.sizes};
}

}  // namespace

void Keyboard::reset() REALTIME {
  keys_ = {};
  registered_ = {};
  channels_ = {};
  members_ = {};
  bows_ = {};
  key_tuning_ = {};
  for (std::size_t key = 0; key < kKeys; ++key) {
    bend_semitones_[key].store(0, std::memory_order_relaxed);
    pressure_[key].store(0, std::memory_order_relaxed);
  }
}

void Keyboard::play(std::span<const std::uint8_t> message, const Playing& playing) REALTIME {
  if (message.empty()) return;
  const std::uint8_t* const bytes = message.data();
  if (bytes[0] == midi::kSystemReset) {
    for (std::size_t key = 0; key < kKeys; ++key) lift(key, playing);
    reset();
    return damp_all(0, playing);
  }
  if (midi::is_exclusive(bytes[0])) return tuning_.take(message, keys_.held());
  if (message.size() < 2) return;
  const auto kind = static_cast<std::uint8_t>(bytes[0] & 0xf0);
  const std::size_t channel = bytes[0] & 0x0f;
  const auto first = static_cast<std::uint8_t>(bytes[1] & 0x7f);
  if (bytes[0] == kTuneKeyHigh || bytes[0] == kTuneKeyLow) return tune_key(message, playing);
  if (kind == midi::kChannelPressure) return press_harder(channel, first / 127.0, playing);
  if (message.size() < 3) return;
  const auto second = static_cast<std::uint8_t>(bytes[2] & 0x7f);
  if (kind == midi::kNoteOn && second > 0) {
    press(first, channel, second, playing);
  } else if (kind == midi::kNoteOn || kind == midi::kNoteOff) {
    release(first, channel, playing);
  } else if (kind == midi::kKeyPressure) {
    if (keys_.is_down(first, channel)) press_key_harder(first, second / 127.0, playing);
  } else if (kind == midi::kPitchBend) {
    // DPF's VST3 writes 128 as the upper byte of a full bend, so it is not masked here.
    const int value = std::min(first + 128 * std::min<int>(bytes[2], 128), 2 * kBendCentre - 1);
    bend(channel, std::clamp((value - kBendCentre) / (kBendCentre - 1.0), -1.0, 1.0), playing);
  } else if (kind == midi::kControl) {
    control(channel, first, second, playing);
  }
}

void Keyboard::tune_key(std::span<const std::uint8_t> message, const Playing& playing) REALTIME {
  if (message.size() < 3) return;
  const std::uint8_t* const bytes = message.data();
  if (bytes[0] == kTuneKeyHigh) {
    tuning_high_ = bytes[2] & 0x7f;
    return;
  }
  const std::size_t key = bytes[1] & 0x7f;
  key_tuning_[key] = tuning_of(128 * tuning_high_ + (bytes[2] & 0x7f));
  bend_key(key, playing);
}

void Keyboard::press(std::size_t key, std::size_t channel, std::uint8_t velocity, const Playing& playing) REALTIME {
  keys_.press(key, channel);
  channel_of_[key] = static_cast<std::uint8_t>(channel);
  pressure_[key].store(0, std::memory_order_relaxed);
  tuning_.press(key, channel);
  bend_key(key, playing);
  const KeyMap::Key& struck = playing.map.keys[key];
  if (!struck.sounds || tuning_.is_unmapped(key)) return;
  strike(key, channel, velocity, playing);
}

// One blow or stroke of a bow, by the parameter "Mallet" or, as struck, by the note map.
void Keyboard::strike(std::size_t key, std::size_t channel, std::uint8_t velocity, const Playing& playing) REALTIME {
  const KeyMap::Key& struck = playing.map.keys[key];
  const auto mallet = static_cast<Mallet>(playing.parameters[Parameter::mallet]);
  const bool is_bowed = mallet == Mallet::bow || (mallet == Mallet::as_struck && struck.bow);
  if (!is_bowed) lift(key, playing);
  if (!takes_event()) return;
  const double bend = bend_semitones(playing.map.objects[struck.object].key);
  const Target target = target_of(struck, velocity, playing.map, playing.parameters, playing.sizes, bend);
  if (is_bowed) {
    const Bows::Stroke stroke = stroke_of(struck, target, playing.map, playing.parameters);
    return bows_.draw(key, stroke, velocity / 127.0, moment_of(playing));
  }
  const double share = (velocity / 127.0) * (velocity / 127.0);
  const double softness = std::exp2(-kHardnessOctaves * channels_[channel].hardness);
  const Blow blow{share, softness, keys_.is_down(HeldKeys::Pedal::damp)};
  if (mallet == Mallet::as_struck) return plugin::strike(playing.mixer, playing.frame, target, blow);
  if (blow.is_dead) pressure_[key].store(1, std::memory_order_relaxed);
  throw_mallet(playing.mixer, playing.frame, target, blow, kMalletInfo[static_cast<std::size_t>(mallet)]);
}

void Keyboard::lift(std::size_t key, const Playing& playing) REALTIME {
  if (bows_.is_drawn(key) && takes_event()) bows_.lift(key, moment_of(playing));
}

void Keyboard::release(std::size_t key, std::size_t channel, const Playing& playing) REALTIME {
  const HeldKeys::Release released = keys_.release(key, channel);
  if (released == HeldKeys::Release::absent) return;
  if (released == HeldKeys::Release::down) {
    channel_of_[key] = static_cast<std::uint8_t>(keys_.channel_of(key));
    return;
  }
  lift(key, playing);
  key_tuning_[key] = 0;  // of the next note
  pressure_[key].store(0, std::memory_order_relaxed);
  if (released == HeldKeys::Release::kept) return;
  if (keys_.is_down(HeldKeys::Pedal::damp)) return damp(key, playing.map.damp_s, playing);
  if (const auto within_s = release_s(playing)) damp(key, *within_s, playing);
}

void Keyboard::control(std::size_t channel, std::uint8_t number, std::uint8_t value, const Playing& playing) REALTIME {
  if (const auto pedal = HeldKeys::pedal_of(number)) {
    const bool was_damped = keys_.is_down(HeldKeys::Pedal::damp);
    damp_released(keys_.move(*pedal, channel, value >= 64), playing);
    if (!was_damped && keys_.is_down(HeldKeys::Pedal::damp)) damp_all(playing.map.damp_s, playing);
  } else if (number == midi::kBreath || number == midi::kExpression || number == midi::kBrightness) {
    if (number == midi::kBrightness) channels_[channel].hardness = std::clamp((value - 64) / 63.0, -1.0, 1.0);
    for (std::size_t key = 0; key < kKeys; ++key) {
      if (follows(key, channel, playing) && takes_change(key)) bows_.set_speed(key, value / 127.0, moment_of(playing));
    }
  } else if (const auto set = registered_.take(channel, number, value)) {
    set_registered(channel, *set, playing);
  } else if (number == midi::kAllSoundOff) {
    for (std::size_t key = 0; key < kKeys; ++key) lift(key, playing);
    damp_all(0, playing);
  } else if (number == midi::kResetControllers || midi::ends_notes(number)) {
    // A master channel of MPE speaks for its zone.
    for (std::size_t one = 0; one < midi::kChannels; ++one) {
      if (one != channel && master_of(one, playing) != channel) continue;
      if (number == midi::kResetControllers) {
        reset_controllers(one, playing);
      } else {
        for (std::size_t key = 0; key < kKeys; ++key) release(key, one, playing);
      }
    }
  }
}

// A configuration message belongs to a master channel and states how many channels its zone has; a range that one of
// them states counts for all of them.
void Keyboard::set_registered(std::size_t channel, session::RegisteredParameters::Setting set,
                              const Playing& playing) REALTIME {
  if (set.parameter == kBendRange) {
    const std::size_t master = master_of(channel, playing);
    for (std::size_t one = 0; one < midi::kChannels; ++one) {
      const bool is_sister = master != kNone && one != master && master_of(one, playing) == master;
      if (one == channel || is_sister) channels_[one].range_semitones = set.value;
    }
  } else if (set.parameter == kMpeConfiguration && (channel == kLowerMaster || channel == kUpperMaster)) {
    constexpr std::size_t kMaxMembers = midi::kChannels - 1;
    std::size_t& own = members_[channel == kLowerMaster ? 0 : 1];
    std::size_t& other = members_[channel == kLowerMaster ? 1 : 0];
    own = std::min<std::size_t>(set.value, kMaxMembers);
    if (own + other + 1 >= kMaxMembers) other = own + 1 >= kMaxMembers ? 0 : kMaxMembers - 1 - own;
    for (Channel& one : channels_) one.range_semitones = -1;
  } else {
    for (std::size_t one = 0; one < midi::kChannels; ++one) {  // a master channel speaks for its zone
      if (one != channel && master_of(one, playing) != channel) continue;
      tuning_.select(one, set.parameter, set.value, keys_.held());
    }
  }
}

// Returns the master channel of the zone to which a channel belongs; kNone for one that plays by itself, and for
// masters. The parameter MPE is a lower zone of all channels.
std::size_t Keyboard::master_of(std::size_t channel, const Playing& playing) const REALTIME {
  const bool all = playing.parameters.on(Parameter::mpe);
  const std::size_t lower = all ? midi::kChannels - 1 : members_[0], upper = all ? 0 : members_[1];
  if (channel != kLowerMaster && channel <= lower) return kLowerMaster;
  if (channel != kUpperMaster && channel + upper >= kUpperMaster) return kUpperMaster;
  return kNone;
}

bool Keyboard::is_master(std::size_t channel, const Playing& playing) const REALTIME {
  const bool all = playing.parameters.on(Parameter::mpe);
  return (channel == kLowerMaster && (all || members_[0] > 0)) || (channel == kUpperMaster && !all && members_[1] > 0);
}

double Keyboard::range_semitones(std::size_t channel, const Playing& playing) const REALTIME {
  if (channels_[channel].range_semitones >= 0) return channels_[channel].range_semitones;
  const bool is_member = master_of(channel, playing) != kNone;
  const bool is_configured = is_member && !playing.parameters.on(Parameter::mpe);
  return is_configured ? kMemberBend_semitones : playing.parameters[Parameter::bend_range];
}

// Resets what RP-015 of the MIDI Association lists, which leaves controller 74 as it is.
void Keyboard::reset_controllers(std::size_t channel, const Playing& playing) REALTIME {
  damp_released(keys_.lift_pedals(channel), playing);
  bend(channel, 0, playing);
  press_harder(channel, 0, playing);
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (follows(key, channel, playing) && takes_change(key)) bows_.reset(key, moment_of(playing));
  }
}

void Keyboard::bend(std::size_t channel, double bend, const Playing& playing) REALTIME {
  channels_[channel].bend = bend;
  for (std::size_t key = 0; key < kKeys; ++key) {
    const std::size_t master = master_of(channel_of_[key], playing);
    // A channel of MPE may have gone on to another key; what the first one left ringing keeps its pitch.
    const bool follows = (master == kNone && !is_master(channel, playing)) || keys_.is_held(key);
    if (follows && (master == channel || channel_of_[key] == channel)) bend_key(key, playing);
  }
}

void Keyboard::bend_key(std::size_t key, const Playing& playing) REALTIME {
  const std::size_t channel = channel_of_[key];
  const std::size_t master = is_master(channel, playing) ? channel : master_of(channel, playing);
  double semitones = key_tuning_[key];
  if (master != channel) semitones += channels_[channel].bend * range_semitones(channel, playing);
  if (master != kNone) {
    const double stated = channels_[master].range_semitones;
    semitones += channels_[master].bend * (stated >= 0 ? stated : kMasterBend_semitones);
  }
  bend_semitones_[key].store(semitones, std::memory_order_relaxed);
}

// Returns whether pressure and the controllers of bows on this channel act on the key.
bool Keyboard::follows(std::size_t key, std::size_t channel, const Playing& playing) const REALTIME {
  return channel_of_[key] == channel || master_of(channel_of_[key], playing) == channel;
}

void Keyboard::press_harder(std::size_t channel, double pressure, const Playing& playing) REALTIME {
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (keys_.is_down(key) && follows(key, channel, playing)) press_key_harder(key, pressure, playing);
  }
}

void Keyboard::press_key_harder(std::size_t key, double pressure, const Playing& playing) REALTIME {
  if (!bows_.is_drawn(key)) return pressure_[key].store(pressure, std::memory_order_relaxed);
  if (takes_change(key)) bows_.set_force(key, pressure, moment_of(playing));
}

// Damps what one key struck, unless another key keeps the object ringing.
void Keyboard::damp(std::size_t key, double within_s, const Playing& playing) REALTIME {
  const KeyMap::Key& struck = playing.map.keys[key];
  if (!struck.sounds || kept(struck.object, playing.map)) return;
  clear(struck.object, within_s, playing);
}

void Keyboard::clear(std::uint32_t object, double within_s, const Playing& playing) REALTIME {
  if (!takes_event()) return;
  ringdown_clear(playing.mixer, playing.frame, playing.map.objects[object].number, within_s, nullptr);
}

bool Keyboard::kept(std::uint32_t object, const KeyMap& map) const REALTIME {
  for (std::size_t key = 0; key < kKeys; ++key) {
    const KeyMap::Key& other = map.keys[key];
    if (other.sounds && other.object == object && keys_.is_held(key)) return true;
  }
  return false;
}

void Keyboard::damp_released(const HeldKeys::Keys& keys, const Playing& playing) REALTIME {
  const auto within_s = release_s(playing);
  if (!within_s) return;
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (keys[key]) damp(key, *within_s, playing);
  }
}

void Keyboard::damp_all(double within_s, const Playing& playing) REALTIME {
  for (std::size_t i = 0; i < playing.map.objects.size(); ++i) {
    clear(static_cast<std::uint32_t>(i), within_s, playing);
  }
}

}  // namespace ringdown::plugin

TRUST_REALTIME_END
