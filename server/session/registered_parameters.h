// Follows MIDI's registered parameters: controllers 101 and 100 name one, and controller 6 sets it. [audio]
//
//   RegisteredParameters registered;
//   if (const auto set = registered.take(channel, number, value)) handle(set->parameter, set->value);
#pragma once

#include "engine/base/realtime.h"
#include "server/session/midi_messages.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ringdown::session {

class RegisteredParameters {
 public:
  struct Setting {
    std::uint8_t parameter;  // one of the first 128, the only ones that anybody uses here
    std::uint8_t value;      // the upper seven bits
  };
  // Takes a controller of a channel. Returns the setting that it makes, if it makes one.
  std::optional<Setting> take(std::size_t channel, std::uint8_t number, std::uint8_t value) REALTIME {
    Name& name = names_[channel];
    if (number == kHigh) name.high = value;
    if (number == kLow) name.low = value;
    if (number == kOtherHigh || number == kOtherLow) name = {};
    if (number != kDataEntry || name.high != 0 || name.low == kNone) return std::nullopt;
    return Setting{name.low, value};
  }

 private:
  static constexpr std::uint8_t kDataEntry = 6, kHigh = 101, kLow = 100;
  static constexpr std::uint8_t kOtherHigh = 99, kOtherLow = 98;  // of parameters that are not registered
  static constexpr std::uint8_t kNone = 127;                      // in both halves: no parameter
  struct Name {
    std::uint8_t high = kNone, low = kNone;
  };
  std::array<Name, midi::kChannels> names_;
};

}  // namespace ringdown::session
