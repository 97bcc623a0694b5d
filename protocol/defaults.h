// What holds when nobody says otherwise: the daemon and every client take it from here. [any thread]
#pragma once

#include <cstdint>

namespace ringdown::protocol {

// The daemon's UDP port: ringdownd binds it, `ringdown strike` and the examples send to it.
inline constexpr std::uint16_t kDefaultPort = 7770;

// Contact time [s] of a strike that names none. An ideal impulse, 0 s, excites every mode up to 20 kHz alike
// and sounds brighter than any real mallet. The force pulse of a real contact is about half a sine, whose
// spectrum falls off above 1/contact_time: 0.2 ms is a hard mallet or a dropped steel ball, 1 ms hard rubber,
// 5 ms a felt beater.
inline constexpr double kDefaultContactTimeS = 0.0002;

// Grows when an address changes its meaning; new addresses and new optional arguments do not count.
inline constexpr std::int32_t kProtocolVersion = 1;

}  // namespace ringdown::protocol
