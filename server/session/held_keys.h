// Tracks the held keys of a MIDI keyboard: by fingers, on one channel or several, or by pedals. [audio]
//
//   HeldKeys keys;
//   keys.press(60, 0);
//   keys.release(60, 1);                                                  // absent: channel 1 does not hold the key
//   if (keys.release(60, 0) == HeldKeys::Release::free) damp(60);
//   const auto freed = keys.move(HeldKeys::Pedal::sustain, 0, false);     // keys to be damped now
//
// A pedal that is down on any channel counts for the keys of all channels, because MPE has a channel for the pedals.
#pragma once

#include "engine/base/realtime.h"
#include "server/session/midi_messages.h"
#include "server/session/note_map_file.h"

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ringdown::session {

class HeldKeys {
 public:
  using Keys = std::bitset<kNotes>;

  // sustain keeps every key that is released while the pedal is down; sostenuto keeps the keys that were down when the
  // pedal went down; damp keeps no key, even if another pedal would.
  enum class Pedal : std::uint8_t { sustain, sostenuto, damp };
  static std::optional<Pedal> pedal_of(std::uint8_t controller) REALTIME;

  void press(std::size_t key, std::size_t channel) REALTIME;

  // The outcome of a release on a channel. absent: the channel does not hold the key, and nothing changes; down:
  // another channel still holds it; kept: it is up, but a pedal keeps it sounding; free: nothing holds it any more.
  enum class Release : std::uint8_t { absent, down, kept, free };
  Release release(std::size_t key, std::size_t channel) REALTIME;

  // Moves a pedal on a channel. Returns the keys that nothing holds any more.
  Keys move(Pedal pedal, std::size_t channel, bool down) REALTIME;
  // Lifts all pedals of a channel.
  Keys lift_pedals(std::size_t channel) REALTIME;

  [[nodiscard]] bool is_down(std::size_t key) const REALTIME { return channels_[key] != 0; }
  [[nodiscard]] bool is_down(std::size_t key, std::size_t channel) const REALTIME;
  [[nodiscard]] bool is_held(std::size_t key) const REALTIME { return is_down(key) || kept_[key]; }
  [[nodiscard]] bool is_down(Pedal pedal) const REALTIME;

  [[nodiscard]] Keys held() const REALTIME;

  // The lowest channel that holds the key, which must be down.
  [[nodiscard]] std::size_t channel_of(std::size_t key) const REALTIME;

 private:
  using Channels = std::uint16_t;  // one bit per channel

  std::array<Channels, kNotes> channels_{};  // channels that hold each key down
  std::array<Channels, 3> pedals_{};         // channels on which each pedal is down
  Keys kept_;                                // keys that are up, but kept by a pedal
  Keys chosen_;                              // keys chosen by sostenuto
};

}  // namespace ringdown::session
