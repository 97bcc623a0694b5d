// What DPF drops, on its way through DPF: note expressions of VST3, and system exclusive messages of VST3 and CLAP. The
// entry of the format collects what a block says, and plugin.cpp turns it into messages for the instrument while DPF
// renders that block. [audio]
#pragma once

#include "clients/plugin/keyboard.h"
#include "engine/base/realtime.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ringdown::plugin {

// A note that begins and the number by which expressions name it, an expression of that note, or a message.
struct NoteSaying {
  enum class Kind : std::uint8_t { begins, tuning, brightness, exclusive };
  Kind kind;
  std::uint8_t channel, key;  // only of a note that begins
  std::uint32_t frame;
  std::int32_t note;
  double value;  // 0 ... 1: tunings from -120 to 120 semitones, brightness from dull to bright
  std::span<const std::uint8_t> message = {};  // only of a system exclusive message
};

struct NoteSayings {
  static constexpr std::size_t kMax = 512;  // further ones are dropped
  std::array<NoteSaying, kMax> list;
  std::size_t count = 0;
  void add(const NoteSaying& saying) REALTIME {
    if (count < kMax) list[count++] = saying;
  }
};

// The sayings of the block that this thread is rendering; null outside of one, and in LV2.
NoteSayings*& sayings_of_block() REALTIME;

// Knows which key each note plays, and writes the messages of its expressions.
class NoteExpressions {
 public:
  using Message = std::array<std::uint8_t, 3>;
  // Returns how many messages a saying makes, at most two, and writes them.
  std::size_t write(const NoteSaying& saying, std::array<Message, 2>& messages) REALTIME;

 private:
  struct Note {
    std::int32_t number = -1;
    std::uint8_t channel = 0;
  };
  std::array<Note, kKeys> notes_{};  // the note that each key played last
};

// A function of the windows, if there are any, that releases the keys which the mouse holds in them. [UI]
inline void (*&let_go_of_keys())() {
  static void (*function)() = nullptr;
  return function;
}

}  // namespace ringdown::plugin
