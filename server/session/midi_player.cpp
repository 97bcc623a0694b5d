#include "server/session/midi_player.h"

#include <algorithm>
#include <cmath>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::EventType;

constexpr std::uint8_t kNoteOff = 0x80, kNoteOn = 0x90, kControl = 0xb0;
constexpr std::uint8_t kSustainPedal = 64, kSoftPedal = 67, kAllSoundOff = 120, kAllNotesOff = 123;
constexpr double kMaxContact_s = 0.1;

}  // namespace

void MidiPlayer::play(std::span<const std::uint8_t> message, synth::Frame frame, const NoteTable& table,
                      synth::Mixer& mixer, SpscRing<Event>& played) RINGDOWN_REALTIME {
  if (message.size() < 3) return;
  const Stage stage{frame, table, mixer, played};
  const std::uint8_t* const bytes = message.data();
  const auto kind = static_cast<std::uint8_t>(bytes[0] & 0xf0);
  const auto first = static_cast<std::uint8_t>(bytes[1] & 0x7f), second = static_cast<std::uint8_t>(bytes[2] & 0x7f);
  if (kind == kNoteOn && second > 0) {
    press(first, second, stage);
  } else if (kind == kNoteOn || kind == kNoteOff) {
    release(first, stage);
  } else if (kind == kControl && first == kAllSoundOff) {
    damp_all(0, stage);
  } else if (kind == kControl && first == kAllNotesOff) {
    for (std::size_t note = 0; note < kNotes; ++note) release(note, stage);
  } else if (kind == kControl) {
    move_pedal(first, second >= 64, stage);
  }
}

void MidiPlayer::press(std::size_t note, std::uint8_t velocity, const Stage& stage) RINGDOWN_REALTIME {
  down_[note] = true;
  sustained_[note] = false;
  const auto& strike = stage.table.notes.data()[note];
  if (!strike) return;
  const double share = (velocity / 127.0) * (velocity / 127.0);
  const double contact_time_s = strike->contact_time_s * std::pow(share, -0.2);
  push({.object = strike->object,
        .type = EventType::strike,
        .point_m = strike->point_m,
        .impulse_ns = share * strike->impulse_ns,
        .contact_time_s = std::min(contact_time_s, kMaxContact_s)},
       stage);
}

void MidiPlayer::release(std::size_t note, const Stage& stage) RINGDOWN_REALTIME {
  if (!down_[note]) return;
  down_[note] = false;
  if (damping_) return damp(note, stage.table.damp_s, stage);
  if (!stage.table.release_s) return;
  if (sustain_) {
    sustained_[note] = true;
  } else {
    damp(note, *stage.table.release_s, stage);
  }
}

void MidiPlayer::move_pedal(std::uint8_t pedal, bool down, const Stage& stage) RINGDOWN_REALTIME {
  if (pedal == kSoftPedal) {
    if (down && !damping_) damp_all(stage.table.damp_s, stage);
    damping_ = down;
  } else if (pedal == kSustainPedal) {
    sustain_ = down;
    if (down) return;
    const NoteSet released = sustained_;
    sustained_.reset();
    for (std::size_t note = 0; note < kNotes; ++note) {
      if (released[note]) damp(note, stage.table.release_s.value_or(stage.table.damp_s), stage);
    }
  }
}

// Damps what one note struck, unless another note keeps the object ringing.
void MidiPlayer::damp(std::size_t note, double within_s, const Stage& stage) RINGDOWN_REALTIME {
  const auto& strike = stage.table.notes.data()[note];
  if (!strike || kept(strike->object, stage.table)) return;
  push({.object = strike->object, .type = EventType::clear, .ramp_s = within_s}, stage);
}

bool MidiPlayer::kept(synth::ObjectNumber object, const NoteTable& table) const RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = table.notes.data()[note];
    if (strike && strike->object == object && (down_[note] || sustained_[note])) return true;
  }
  return false;
}

void MidiPlayer::damp_all(double within_s, const Stage& stage) RINGDOWN_REALTIME {
  for (std::size_t note = 0; note < kNotes; ++note) {
    const auto& strike = stage.table.notes.data()[note];
    if (strike) push({.object = strike->object, .type = EventType::clear, .ramp_s = within_s}, stage);
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
