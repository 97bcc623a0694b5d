#include "clients/plugin/clap_events.h"

#include "clients/plugin/keyboard.h"

#include <algorithm>
#include <cmath>

namespace ringdown::plugin::clap {
namespace {

constexpr int kPort = 0;

std::uint8_t seven_bits(double share) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * 127));
}

bool is_key(int key) { return key >= 0 && key < static_cast<int>(kKeys); }

// Returns whether an event is for our port; hosts name all ports by -1.
bool is_ours(int port) { return port == kPort || port == -1; }

}  // namespace

void Events::take(const clap_input_events_t* given, ParameterValues& parameters) {
  used_ = midi_used_ = 0;
  sayings_.count = 0;
  given_ = given ? given->size(given) : 0;
  for (std::uint32_t i = 0; i < given_; ++i) take(*given->get(given, i), parameters);
}

void Events::take(const clap_event_header_t& event, ParameterValues& parameters) {
  if (event.space_id != CLAP_CORE_EVENT_SPACE_ID) return;
  switch (event.type) {
    case CLAP_EVENT_MIDI:
      if (reinterpret_cast<const clap_event_midi_t&>(event).port_index == kPort) add(event);
      return;
    case CLAP_EVENT_MIDI_SYSEX: {
      const auto& exclusive = reinterpret_cast<const clap_event_midi_sysex_t&>(event);
      if (exclusive.port_index != kPort) return;
      return sayings_.add({NoteSaying::Kind::exclusive, 0, 0, event.time, -1, 0, {exclusive.buffer, exclusive.size}});
    }
    case CLAP_EVENT_NOTE_ON:
      return press(reinterpret_cast<const clap_event_note_t&>(event));
    case CLAP_EVENT_NOTE_OFF:
    case CLAP_EVENT_NOTE_CHOKE:
      return release(reinterpret_cast<const clap_event_note_t&>(event));
    case CLAP_EVENT_PARAM_VALUE:
      if (reinterpret_cast<const clap_event_param_value_t&>(event).param_id < kParameters) add(event);
      return;
    case CLAP_EVENT_PARAM_MOD: {
      const auto& modulation = reinterpret_cast<const clap_event_param_mod_t&>(event);
      if (modulation.note_id < 0 && modulation.key < 0) parameters.modulate(modulation.param_id, modulation.amount);
      return;
    }
    case CLAP_EVENT_NOTE_EXPRESSION:
      return express(reinterpret_cast<const clap_event_note_expression_t&>(event));
    default:
      return;
  }
}

void Events::add(const clap_event_header_t& event) {
  if (used_ < kMaxEvents) events_[used_++] = &event;
}

void Events::add_midi(std::uint32_t time, std::uint8_t status, int first, int second) {
  if (midi_used_ == kMaxMidi) return;
  clap_event_midi_t& midi = midi_[midi_used_++];
  midi = {{sizeof midi, time, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI, 0},
          kPort,
          {status, static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(second)}};
  add(midi.header);
}

// Adds a message on a channel, or on all channels if it is negative, as CLAP has it.
void Events::add_midi_on(int channel, std::uint32_t time, int kind, int first, int second) {
  for (int one = 0; one < 16; ++one) {
    if (channel < 0 || channel == one) add_midi(time, static_cast<std::uint8_t>(kind | one), first, second);
  }
}

void Events::press(const clap_event_note_t& event) {
  if (!is_ours(event.port_index) || !is_key(event.key)) return;
  const int velocity = std::max<int>(1, seven_bits(event.velocity));
  add_midi_on(std::max<int>(0, event.channel), event.header.time, 0x90, event.key, velocity);
}

// A release without a key is one of all keys.
void Events::release(const clap_event_note_t& event) {
  if (!is_ours(event.port_index)) return;
  if (is_key(event.key)) return add_midi_on(event.channel, event.header.time, 0x80, event.key, 0);
  add_midi_on(event.channel, event.header.time, 0xb0, 123, 0);
}

// An expression without a key is one of all keys that its channel plays.
void Events::express(const clap_event_note_expression_t& event) {
  if (!is_ours(event.port_index)) return;
  const int channel = event.channel;
  const std::uint32_t time = event.header.time;
  if (event.expression_id == CLAP_NOTE_EXPRESSION_PRESSURE) {
    if (is_key(event.key)) return add_midi_on(channel, time, 0xa0, event.key, seven_bits(event.value));
    return add_midi_on(channel, time, 0xd0, seven_bits(event.value), 0);
  }
  if (event.expression_id == CLAP_NOTE_EXPRESSION_BRIGHTNESS) {
    return add_midi_on(channel, time, 0xb0, 74, seven_bits(event.value));
  }
  const bool is_tuning = event.expression_id == CLAP_NOTE_EXPRESSION_TUNING;
  if (!is_tuning || !is_key(event.key) || !std::isfinite(event.value)) return;
  const int code = tuning_code(event.value);
  add_midi(time, kTuneKeyHigh, event.key, code >> 7);
  add_midi(time, kTuneKeyLow, event.key, code & 0x7f);
}

}  // namespace ringdown::plugin::clap
