// Default values, which the daemon and every client take from here. [any thread]
#pragma once

#include <cstdint>

namespace ringdown::protocol {

// The daemon's UDP port: ringdownd binds it, `ringdown strike` and the examples send to it.
inline constexpr std::uint16_t kDefaultPort = 7770;

// Grows when an address changes its meaning; new addresses and new optional arguments do not count.
inline constexpr std::int32_t kProtocolVersion = 1;

// The most that one message carries: bytes of a bank file, frames of sound, amplitudes of modes.
inline constexpr std::uint32_t kMaxBankBytes = 8192, kMaxSoundFrames = 256, kMaxModeAmplitudes = 512;

// Audio inputs that may excite objects.
inline constexpr std::uint32_t kMaxInputs = 4;

// Pickups of a mixer, each with an output of its own.
inline constexpr std::uint32_t kMaxPickups = 8;

}  // namespace ringdown::protocol
