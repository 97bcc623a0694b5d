// The bytes of the MIDI messages that are played. [any]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::session::midi {

// The upper half of a message's first byte; the lower half is the channel.
inline constexpr std::uint8_t kNoteOff = 0x80, kNoteOn = 0x90, kKeyPressure = 0xa0, kControl = 0xb0,
                              kChannelPressure = 0xd0, kPitchBend = 0xe0;
inline constexpr std::uint8_t kSystemReset = 0xff;  // the whole message
inline constexpr std::uint8_t kSystemExclusive = 0xf0;
inline constexpr std::size_t kChannels = 16;

// Controllers.
inline constexpr std::uint8_t kBreath = 2, kExpression = 11, kSustainPedal = 64, kSostenutoPedal = 66, kSoftPedal = 67,
                              kBrightness = 74, kAllSoundOff = 120, kResetControllers = 121, kAllNotesOff = 123;

// Returns true for a system exclusive message. Some hosts leave out its first byte, so that it begins with data.
constexpr bool is_exclusive(std::uint8_t first_byte) REALTIME {
  return first_byte == kSystemExclusive || first_byte < 0x80;
}

// Returns true for all notes off and for the four changes of mode (omni off and on, mono, poly), which also end notes.
constexpr bool ends_notes(std::uint8_t controller) REALTIME { return controller >= kAllNotesOff; }

}  // namespace ringdown::session::midi
