// Converts MIDI to events: notes strike objects; released notes and the damp pedal damp them. [audio]
//
// A note's velocity v, 1 to 127, gives the share (v / 127)^2 of its full impulse J, so that the lowest is 84 dB below
// the highest; the blow lasts (J_full / J)^(1/5) times as long as at full velocity, by Hertz's law of contact: soft
// blows are duller.
//
// A bowed note draws its bow while its key is down: at v / 127 of its full speed, and at kFirstBowPressure of its full
// force until the key's or the channel's pressure changes the force. Controllers 2, 11 and 74 set the speed of all bows
// on their channel, so an MPE keyboard, with a channel for each note, controls each bow separately. Reset all
// controllers (RP-015 of the MIDI Association) lifts its channel's pedals and returns its bows to their first speed and
// force.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/spsc_ring.h"
#include "engine/microtuning/played_tuning.h"
#include "engine/synth/events/event.h"
#include "engine/synth/mixer.h"
#include "server/session/held_keys.h"
#include "server/session/note_map.h"
#include "server/session/registered_parameters.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

namespace ringdown::session {

class MidiPlayer {
 public:
  // Plays one message at `frame`. Messages other than notes, pedals, bows, tunings and resets are ignored. Each event
  // that the mixer took is also put into `played`, as long as there is room.
  void play(std::span<const std::uint8_t> message, synth::Frame frame, const NoteTable& table, synth::Mixer& mixer,
            SpscRing<synth::Event>& played) REALTIME;

  // The tuning of the keys, for NoteTuner.
  [[nodiscard]] microtuning::PlayedTuning& tuning() { return tuning_; }

  // Events lost because the mixer's queue was full. [any]
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  struct Playing {
    synth::Frame frame;
    const NoteTable& table;
    synth::Mixer& mixer;
    SpscRing<synth::Event>& played;
  };
  void press(std::size_t note, std::uint8_t velocity, std::uint8_t channel, const Playing& playing) REALTIME;
  void release(std::size_t note, std::uint8_t channel, const Playing& playing) REALTIME;
  void control(std::uint8_t channel, std::uint8_t number, std::uint8_t value, const Playing& playing) REALTIME;
  void reset(const Playing& playing) REALTIME;
  void damp(std::size_t note, double within_s, const Playing& playing) REALTIME;
  void damp_released(const HeldKeys::Keys& keys, const Playing& playing) REALTIME;
  void damp_all(double within_s, const Playing& playing) REALTIME;
  [[nodiscard]] bool kept(synth::ObjectNumber object, const NoteTable& table) const REALTIME;
  void draw(std::size_t note, const Playing& playing) REALTIME;
  void lift(std::size_t note, const Playing& playing) REALTIME;
  template <class Change>
  void change_bows(std::uint8_t channel, const Playing& playing, const Change& change) REALTIME;
  void push(const synth::Event& event, const Playing& playing) REALTIME;

  HeldKeys keys_;
  RegisteredParameters registered_;
  microtuning::PlayedTuning tuning_;
  struct Bow {
    std::uint8_t channel = 0;
    float first_speed = 0;       // speed when the key went down
    float speed = 0, force = 0;  // shares of the full ones
    bool drawn = false;
  };
  std::array<Bow, kNotes> bows_;
  std::atomic<std::uint64_t> dropped_ = 0;
};

}  // namespace ringdown::session
