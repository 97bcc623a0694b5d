// Default values, which the daemon and every client take from here. [any thread]
#pragma once

#include <cstdint>

namespace ringdown::protocol {

// The daemon's UDP port: ringdownd binds it, `ringdown strike` and the examples send to it.
inline constexpr std::uint16_t kDefaultPort = 7770;

// Contact time [s] of a strike that names none. An ideal impulse, 0 s, excites every mode up to 20 kHz alike and sounds
// brighter than any real mallet. The force of a real contact is about half a sine in time, whose spectrum falls off
// above 1/contact_time. Hertz's law for a ball that meets steel at 1 m/s (K. L. Johnson, Contact Mechanics,
// equation 11.24) gives 0.07 ms for steel of 10 mm radius, and for 15 mm 0.1 ms of hardwood (E = 11 GPa), 0.2 ms of
// hard plastic (3 GPa) and 0.7 ms of hard rubber (0.1 GPa). Ours is the plastic mallet.
inline constexpr double kDefaultContactTimeS = 0.0002;

// Grows when an address changes its meaning; new addresses and new optional arguments do not count.
inline constexpr std::int32_t kProtocolVersion = 1;

// Amplitude, of full scale, at which /object/{object}/ring and /test_tone sound when they name none: -20 dB.
inline constexpr double kDefaultRingAmplitude = 0.1;

// The most that one message carries: bytes of a bank file, frames of sound, amplitudes of modes.
inline constexpr std::uint32_t kMaxBankBytes = 8192, kMaxSoundFrames = 256, kMaxModeAmplitudes = 512;

// Audio inputs that may excite objects.
inline constexpr std::uint32_t kMaxInputs = 4;

}  // namespace ringdown::protocol
