#include "server/session/midi_player.h"

#include "protocol/request.h"

#include <algorithm>
#include <cmath>

namespace ringdown::session {
namespace {

using synth::Event;

constexpr double kMaxContact_s = 0.1;
constexpr float kFirstPressure = 0.5F;  // pressure of a bow before any message

float share_of(std::uint8_t value) RINGDOWN_REALTIME { return static_cast<float>(value) / 127.0F; }

}  // namespace

void MidiPlayer::play(std::span<const std::uint8_t> message, synth::Frame frame, const NoteTable& table,
                      synth::Mixer& mixer, SpscRing<Event>& played) RINGDOWN_REALTIME {
  if (message.empty()) return;
  const Stage stage{frame, table, mixer, played};
  const std::uint8_t* const bytes = message.data();
  if (bytes[0] == midi::kSystemReset) return reset(stage);
  if (message.size() < 2) return;
  const auto kind = static_cast<std::uint8_t>(bytes[0] & 0xf0), channel = static_cast<std::uint8_t>(bytes[0] & 0x0f);
  if (kind == midi::kChannelPressure) {
    const float share = share_of(bytes[1] & 0x7f);
    return change_bows(channel, stage, [share](Bow& bow) RINGDOWN_REALTIME { bow.force = share; });
  }
  if (message.size() < 3) return;
  const auto first = static_cast<std::uint8_t>(bytes[1] & 0x7f), second = static_cast<std::uint8_t>(bytes[2] & 0x7f);
  if (kind == midi::kNoteOn && second > 0) {
    press(first, second, channel, stage);
  } else if (kind == midi::kNoteOn || kind == midi::kNoteOff) {
    release(first, channel, stage);
  } else if (kind == midi::kKeyPressure && bows_[first].drawn && bows_[first].channel == channel) {
    bows_[first].force = share_of(second);
    draw(first, stage);
  } else if (kind == midi::kControl) {
    control(channel, first, second, stage);
  }
}

void MidiPlayer::press(std::size_t note, std::uint8_t velocity, std::uint8_t channel,
                       const Stage& stage) RINGDOWN_REALTIME {
  keys_.press(note, channel);
  const auto& strike = stage.table.notes.data()[note];
  if (!strike) return;
  if (strike->bow) {
    const float speed = share_of(velocity);
    bows_[note] = {channel, speed, speed, kFirstPressure, true};
    return draw(note, stage);
  }
  const double share = (velocity / 127.0) * (velocity / 127.0);
  const double contact_time_s = strike->contact_time_s * std::pow(share, -0.2);
  push({.object = strike->object,
        .verb =
            synth::verb::Strike{strike->point_m, share * strike->impulse_ns, std::min(contact_time_s, kMaxContact_s)}},
       stage);
}

void MidiPlayer::release(std::size_t note, std::uint8_t channel, const Stage& stage) RINGDOWN_REALTIME {
  switch (keys_.release(note, channel)) {
    case HeldKeys::Release::absent:
      return;
    case HeldKeys::Release::down:
      bows_[note].channel = static_cast<std::uint8_t>(keys_.channel_of(note));
      return;
    case HeldKeys::Release::kept:
      return lift(note, stage);
    case HeldKeys::Release::free:
      break;
  }
  lift(note, stage);
  if (keys_.is_down(HeldKeys::Pedal::damp)) return damp(note, stage.table.damp_s, stage);
  if (stage.table.release_s) damp(note, *stage.table.release_s, stage);
}

void MidiPlayer::control(std::uint8_t channel, std::uint8_t number, std::uint8_t value,
                         const Stage& stage) RINGDOWN_REALTIME {
  if (const auto pedal = HeldKeys::pedal_of(number)) {
    const bool was_damped = keys_.is_down(HeldKeys::Pedal::damp);
    damp_released(keys_.move(*pedal, channel, value >= 64), stage);
    if (!was_damped && keys_.is_down(HeldKeys::Pedal::damp)) damp_all(stage.table.damp_s, stage);
  } else if (number == midi::kExpression || number == midi::kBrightness) {
    change_bows(channel, stage, [value](Bow& bow) RINGDOWN_REALTIME { bow.speed = share_of(value); });
  } else if (number == midi::kAllSoundOff) {
    for (std::size_t note = 0; note < kNotes; ++note) lift(note, stage);
    damp_all(0, stage);
  } else if (number == midi::kResetControllers) {
    damp_released(keys_.lift_pedals(channel), stage);
    change_bows(channel, stage, [](Bow& bow) RINGDOWN_REALTIME {
      bow.speed = bow.first_speed;
      bow.force = kFirstPressure;
    });
  } else if (midi::ends_notes(number)) {
    for (std::size_t note = 0; note < kNotes; ++note) release(note, channel, stage);
  }
}

void MidiPlayer::reset(const Stage& stage) RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) lift(note, stage);
  keys_ = {};
  damp_all(0, stage);
}

void MidiPlayer::damp_released(const HeldKeys::Keys& keys, const Stage& stage) RINGDOWN_REALTIME {
  if (!stage.table.release_s) return;
  for (std::size_t note = 0; note < kNotes; ++note) {
    if (keys[note]) damp(note, *stage.table.release_s, stage);
  }
}

// Damps the object that a note struck, unless another note keeps the object ringing.
void MidiPlayer::damp(std::size_t note, double within_s, const Stage& stage) RINGDOWN_REALTIME {
  const auto& strike = stage.table.notes.data()[note];
  if (!strike || kept(strike->object, stage.table)) return;
  push({.object = strike->object, .verb = synth::verb::Clear{within_s}}, stage);
}

bool MidiPlayer::kept(synth::ObjectNumber object, const NoteTable& table) const RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = table.notes.data()[note];
    if (strike && strike->object == object && keys_.is_held(note)) return true;
  }
  return false;
}

void MidiPlayer::damp_all(double within_s, const Stage& stage) RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = stage.table.notes.data()[note];
    if (strike) push({.object = strike->object, .verb = synth::verb::Clear{within_s}}, stage);
  }
}

// Sets the note's bow to its speed and force.
void MidiPlayer::draw(std::size_t note, const Stage& stage) RINGDOWN_REALTIME {
  const auto& strike = stage.table.notes.data()[note];
  if (!strike || !strike->bow) return;
  const Bow& bow = bows_[note];
  const synth::verb::Bow drawn{.point_m = strike->point_m,
                               .direction = strike->bow->direction,
                               .speed_m_s = static_cast<double>(bow.speed) * strike->bow->speed_m_s,
                               .force_n = bow.drawn ? static_cast<double>(bow.force) * strike->bow->force_n : 0.0,
                               .number = static_cast<std::uint32_t>(note)};
  push({.object = strike->object, .verb = drawn}, stage);
}

void MidiPlayer::lift(std::size_t note, const Stage& stage) RINGDOWN_REALTIME {
  if (!bows_[note].drawn) return;
  bows_[note].drawn = false;
  draw(note, stage);
}

template <class Change>
void MidiPlayer::change_bows(std::uint8_t channel, const Stage& stage, const Change& change) RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    if (!bows_[note].drawn || bows_[note].channel != channel) continue;
    change(bows_[note]);
    draw(note, stage);
  }
}

void MidiPlayer::push(const Event& event, const Stage& stage) RINGDOWN_REALTIME {
  Event timed = event;
  timed.frame = stage.frame;
  if (stage.mixer.push(synth::Producer::midi, timed)) {
    static_cast<void>(stage.played.push(timed));
  } else {
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace ringdown::session
