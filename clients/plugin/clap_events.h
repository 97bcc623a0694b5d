// The events of one CLAP block as DPF understands them: MIDI and values of parameters. Modulation goes to the
// instrument itself. Nothing here allocates. [audio]
//
// - Notes become MIDI; a velocity of 0 is the softest blow, not a release. Releases may name all keys.
// - Of note expressions, pressure is the key's aftertouch, brightness controller 74, tuning a bend of the key.
// - Events that DPF would misread are left out: gestures, transport, other ports, unknown parameters.
#pragma once

#include "clients/plugin/parameters.h"
#include "clients/plugin/vst3_notes.h"

#include "src/clap/events.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::plugin::clap {

class Events {
 public:
  // Takes the host's events, which may be null.
  void take(const clap_input_events_t* given, ParameterValues& parameters);

  [[nodiscard]] const clap_input_events_t* list() const { return &list_; }
  [[nodiscard]] NoteSayings& sayings() { return sayings_; }  // the system exclusive messages
  [[nodiscard]] bool empty() const { return given_ == 0 && used_ == 0; }

 private:
  static constexpr std::size_t kMaxEvents = 2048, kMaxMidi = 512;  // of a block; further ones are dropped, by DPF too

  void take(const clap_event_header_t& event, ParameterValues& parameters);
  void add(const clap_event_header_t& event);
  void add_midi(std::uint32_t time, std::uint8_t status, int first, int second);
  void add_midi_on(int channel, std::uint32_t time, int kind, int first, int second);
  void press(const clap_event_note_t& event);
  void release(const clap_event_note_t& event);
  void express(const clap_event_note_expression_t& event);

  std::array<const clap_event_header_t*, kMaxEvents> events_{};
  std::array<clap_event_midi_t, kMaxMidi> midi_{};
  std::size_t used_ = 0, midi_used_ = 0;
  std::uint32_t given_ = 0;
  NoteSayings sayings_;
  clap_input_events_t list_{this,
                            [](const clap_input_events_t* list) {
                              return static_cast<std::uint32_t>(static_cast<const Events*>(list->ctx)->used_);
                            },
                            [](const clap_input_events_t* list, std::uint32_t index) -> const clap_event_header_t* {
                              return static_cast<const Events*>(list->ctx)->events_[index];
                            }};
};

}  // namespace ringdown::plugin::clap
