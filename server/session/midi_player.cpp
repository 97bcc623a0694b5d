#include "server/session/midi_player.h"

#include "protocol/request.h"

#include <algorithm>
#include <cmath>

namespace ringdown::session {
namespace {

using synth::Event;

constexpr double kMaxContact_s = 0.1;

float share_of(std::uint8_t value) REALTIME { return static_cast<float>(value) / 127.0F; }

}  // namespace

void MidiPlayer::play(std::span<const std::uint8_t> message, synth::Frame frame, const NoteTable& table,
                      synth::Mixer& mixer, SpscRing<Event>& played) REALTIME {
  if (message.empty()) return;
  const Playing playing{frame, table, mixer, played};
  const std::uint8_t* const bytes = message.data();
  if (bytes[0] == midi::kSystemReset) return reset(playing);
  if (midi::is_exclusive(bytes[0])) return tuning_.take(message, keys_.held());
  if (message.size() < 2) return;
  const auto kind = static_cast<std::uint8_t>(bytes[0] & 0xf0), channel = static_cast<std::uint8_t>(bytes[0] & 0x0f);
  if (kind == midi::kChannelPressure) {
    const float share = share_of(bytes[1] & 0x7f);
    return change_bows(channel, playing, [share](Bow& bow) REALTIME { bow.force = share; });
  }
  if (message.size() < 3) return;
  const auto first = static_cast<std::uint8_t>(bytes[1] & 0x7f), second = static_cast<std::uint8_t>(bytes[2] & 0x7f);
  if (kind == midi::kNoteOn && second > 0) {
    press(first, second, channel, playing);
  } else if (kind == midi::kNoteOn || kind == midi::kNoteOff) {
    release(first, channel, playing);
  } else if (kind == midi::kKeyPressure && bows_[first].drawn && bows_[first].channel == channel) {
    bows_[first].force = share_of(second);
    draw(first, playing);
  } else if (kind == midi::kControl) {
    control(channel, first, second, playing);
  }
}

void MidiPlayer::press(std::size_t note, std::uint8_t velocity, std::uint8_t channel, const Playing& playing) REALTIME {
  keys_.press(note, channel);
  tuning_.press(note, channel);
  const auto& strike = playing.table.notes[note];
  if (!strike || tuning_.is_unmapped(note)) return;
  if (strike->bow) {
    const float speed = share_of(velocity);
    bows_[note] = {channel, speed, speed, kFirstBowPressure, true};
    return draw(note, playing);
  }
  const double share = (velocity / 127.0) * (velocity / 127.0);
  const double contact_time_s = strike->contact_time_s * std::pow(share, -0.2);
  push({.object = strike->object,
        .verb =
            synth::verb::Strike{strike->point_m, share * strike->impulse_ns, std::min(contact_time_s, kMaxContact_s)}},
       playing);
}

void MidiPlayer::release(std::size_t note, std::uint8_t channel, const Playing& playing) REALTIME {
  switch (keys_.release(note, channel)) {
    case HeldKeys::Release::absent:
      return;
    case HeldKeys::Release::down:
      bows_[note].channel = static_cast<std::uint8_t>(keys_.channel_of(note));
      return;
    case HeldKeys::Release::kept:
      return lift(note, playing);
    case HeldKeys::Release::free:
      break;
  }
  lift(note, playing);
  if (keys_.is_down(HeldKeys::Pedal::damp)) return damp(note, playing.table.damp_s, playing);
  if (playing.table.release_s) damp(note, *playing.table.release_s, playing);
}

void MidiPlayer::control(std::uint8_t channel, std::uint8_t number, std::uint8_t value,
                         const Playing& playing) REALTIME {
  if (const auto pedal = HeldKeys::pedal_of(number)) {
    const bool was_damped = keys_.is_down(HeldKeys::Pedal::damp);
    damp_released(keys_.move(*pedal, channel, value >= 64), playing);
    if (!was_damped && keys_.is_down(HeldKeys::Pedal::damp)) damp_all(playing.table.damp_s, playing);
  } else if (number == midi::kBreath || number == midi::kExpression || number == midi::kBrightness) {
    change_bows(channel, playing, [value](Bow& bow) REALTIME { bow.speed = share_of(value); });
  } else if (const auto set = registered_.take(channel, number, value)) {
    tuning_.select(channel, set->parameter, set->value, keys_.held());
  } else if (number == midi::kAllSoundOff) {
    for (std::size_t note = 0; note < kNotes; ++note) lift(note, playing);
    damp_all(0, playing);
  } else if (number == midi::kResetControllers) {
    damp_released(keys_.lift_pedals(channel), playing);
    change_bows(channel, playing, [](Bow& bow) REALTIME {
      bow.speed = bow.first_speed;
      bow.force = kFirstBowPressure;
    });
  } else if (midi::ends_notes(number)) {
    for (std::size_t note = 0; note < kNotes; ++note) release(note, channel, playing);
  }
}

void MidiPlayer::reset(const Playing& playing) REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) lift(note, playing);
  keys_ = {};
  registered_ = {};
  damp_all(0, playing);
}

void MidiPlayer::damp_released(const HeldKeys::Keys& keys, const Playing& playing) REALTIME {
  if (!playing.table.release_s) return;
  for (std::size_t note = 0; note < kNotes; ++note) {
    if (keys[note]) damp(note, *playing.table.release_s, playing);
  }
}

// Damps what one note struck, unless another note keeps the object ringing.
void MidiPlayer::damp(std::size_t note, double within_s, const Playing& playing) REALTIME {
  const auto& strike = playing.table.notes[note];
  if (!strike || kept(strike->object, playing.table)) return;
  push({.object = strike->object, .verb = synth::verb::Clear{within_s}}, playing);
}

bool MidiPlayer::kept(synth::ObjectNumber object, const NoteTable& table) const REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = table.notes[note];
    if (strike && strike->object == object && keys_.is_held(note)) return true;
  }
  return false;
}

void MidiPlayer::damp_all(double within_s, const Playing& playing) REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = playing.table.notes[note];
    if (strike) push({.object = strike->object, .verb = synth::verb::Clear{within_s}}, playing);
  }
}

// Sets the note's bow to its speed and force.
void MidiPlayer::draw(std::size_t note, const Playing& playing) REALTIME {
  const auto& strike = playing.table.notes[note];
  if (!strike || !strike->bow) return;
  const Bow& bow = bows_[note];
  const synth::verb::Bow drawn{.point_m = strike->point_m,
                               .direction = strike->bow->direction,
                               .speed_m_s = static_cast<double>(bow.speed) * strike->bow->speed_m_s,
                               .force_n = bow.drawn ? static_cast<double>(bow.force) * strike->bow->force_n : 0.0,
                               .number = static_cast<std::uint32_t>(note)};
  push({.object = strike->object, .verb = drawn}, playing);
}

void MidiPlayer::lift(std::size_t note, const Playing& playing) REALTIME {
  if (!bows_[note].drawn) return;
  bows_[note].drawn = false;
  draw(note, playing);
}

template <class Change>
void MidiPlayer::change_bows(std::uint8_t channel, const Playing& playing, const Change& change) REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    if (!bows_[note].drawn || bows_[note].channel != channel) continue;
    change(bows_[note]);
    draw(note, playing);
  }
}

void MidiPlayer::push(const Event& event, const Playing& playing) REALTIME {
  Event timed = event;
  timed.frame = playing.frame;
  if (playing.mixer.push(synth::Producer::midi, timed)) {
    static_cast<void>(playing.played.push(timed));
  } else {
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace ringdown::session
