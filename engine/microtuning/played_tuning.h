// The pitches that the keys of one keyboard have at this moment: those of a tuning that the worker sets, and those of
// messages of the MIDI Tuning Standard, which precede. The audio thread takes messages; the worker reads the pitches
// and gives the keys' objects the sizes for them.
//
// MESSAGES. A tuning program is a pitch for each of 128 keys. These messages (F0 7E for "non real time" or F0 7F for
// "real time", a device, 08) change one:
//
//   01 tt name[16] [xx yy zz]x128 checksum      bulk dump of program tt
//   04 bb tt name[16] [xx yy zz]x128 checksum   bulk dump of program tt of bank bb
//   05 bb tt name[16] [ss]x12 checksum          bulk dump of program tt of bank bb: one scale for all octaves
//   06 bb tt name[16] [ss tt]x12 checksum       the same with two bytes for each degree
//   02 tt ll [kk xx yy zz]xll                   keys of program tt
//   07 bb tt ll [kk xx yy zz]xll                keys of program tt of bank bb
//
// and these tune channels, as a set of 16 bits: 15 and 16 in ff, 8 to 14 in gg, 1 to 7 in hh, lowest bits first.
//
//   08 ff gg hh [ss]x12                         one scale for all octaves
//   09 ff gg hh [ss tt]x12                      the same with two bytes for each degree
//
// A pitch is xx semitones and 128 yy + zz parts of 16384 of a semitone; 7F 7F 7F changes nothing. A scale states for
// the degrees C, C sharp ... B how far they lie above equal temperament: ss - 64 cents, or 128 ss + tt - 8192 parts of
// 8192 of a semitone. Each channel plays program 0 of bank 0, until the registered parameters 3 and 4 choose another
// program and bank; a scale of the channel precedes the program, until one of these parameters arrives. Real-time
// messages also retune keys that are held; others reach those when they are struck again. Checksums are not compared,
// because senders disagree about the bytes that they cover. All devices are addressed.
#pragma once

#include "engine/base/realtime.h"
#include "engine/microtuning/key_tuning.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace ringdown::microtuning {

inline constexpr std::uint8_t kTuningProgram = 3, kTuningBank = 4;  // registered parameters

class PlayedTuning {
 public:
  PlayedTuning() {
    for (std::atomic<float>& pitch : stated_) pitch = kUnset;
  }

  static constexpr std::size_t kMaxPrograms = 128;  // messages about further ones are ignored

  // Takes a system exclusive message, with or without its first byte F0 and its last byte F7. Ignores messages that are
  // about something else, or damaged. `held`: the keys that are held. [audio]
  void take(std::span<const std::uint8_t> message, const KeySet& held) REALTIME;

  // Sets kTuningProgram or kTuningBank of a channel; other parameters are ignored. [audio]
  void select(std::size_t channel, std::uint8_t parameter, std::uint8_t value, const KeySet& held) REALTIME;

  // Gives the key the pitch that its channel has for it; call it when the key is pressed. [audio]
  void press(std::size_t key, std::size_t channel) REALTIME;

  // Sets the tuning of the keys whose pitch no message has set. [worker]
  void set_base(const KeyTuning& tuning);

  // The key's pitch above equal temperament, and whether it is unmapped. [any]
  [[nodiscard]] double semitones(std::size_t key) const REALTIME;
  [[nodiscard]] bool is_unmapped(std::size_t key) const REALTIME;

 private:
  static constexpr std::size_t kChannels = 16;
  static constexpr float kUnset = std::numeric_limits<float>::quiet_NaN();  // no message has set this pitch
  struct Address {
    std::uint8_t bank = 0, program = 0;
    friend bool operator==(const Address&, const Address&) = default;
  };
  struct Program {
    Address address;
    std::array<float, kKeys> semitones;  // above equal temperament; a float holds all 21 bits of a message
  };
  static constexpr std::size_t kDegrees = 12;  // of a scale, from C
  struct Scale {
    std::array<float, kDegrees> semitones{};  // above equal temperament
    bool is_set = false;
  };
  [[nodiscard]] Program* find(const Address& address) REALTIME;
  [[nodiscard]] Program* find_or_add(const Address& address) REALTIME;
  void take_dump(const Address& address, std::span<const std::uint8_t> pitches, const KeySet& kept) REALTIME;
  void take_keys(const Address& address, std::span<const std::uint8_t> keys, const KeySet& kept) REALTIME;
  void take_scale_dump(const Address& address, std::span<const std::uint8_t> dump, std::size_t bytes,
                       const KeySet& kept) REALTIME;
  void take_scale(std::span<const std::uint8_t> message, std::size_t bytes, const KeySet& kept) REALTIME;
  [[nodiscard]] static Scale scale_of(std::span<const std::uint8_t> degrees, std::size_t bytes) REALTIME;
  void update(const KeySet& kept) REALTIME;
  void update_key(std::size_t key) REALTIME;

  std::size_t used_ = 0;
  std::array<Program, kMaxPrograms> programs_;
  std::array<Address, kChannels> selected_{};
  std::array<Scale, kChannels> scales_{};         // of channels
  std::array<std::uint8_t, kKeys> channel_of_{};  // the channel that last played the key
  std::array<std::atomic<float>, kKeys> stated_;  // by messages, above equal temperament
  std::array<std::atomic<double>, kKeys> base_{};
  std::array<std::atomic<bool>, kKeys> unmapped_{};
};

}  // namespace ringdown::microtuning
