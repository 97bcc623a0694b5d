// The keyboard's state and the effects of MIDI: notes strike, released notes and pedals damp, bends and pressure wait
// for the worker, which retunes. [audio, except where stated otherwise]
//
// A velocity v gives the share (v / 127)^2 of the full impulse, and the blow lasts share^(-1/5) times as long as the
// full one, by Hertz's law: soft blows are duller. Controller 74 makes blows harder or softer. Mallets and bows follow
// the parameter "Mallet" (mallets.h); a mallet that strikes while the damp pedal is down stays on the object, as a full
// hand, until its key is released.
//
// A bow has v / 127 of its full speed until a controller (2, 11 or 74) of its channel changes it, and half of its full
// force until pressure does. Where a bow is drawn, pressure is no hand.
//
// Two messages that MIDI leaves undefined bend a single key; only clap_entry.cpp sends them, for CLAP's note
// expressions: kTuneKeyHigh key h, then kTuneKeyLow key l, for the 14-bit number 128 h + l that tuning_code() makes.
#pragma once

#include "clients/plugin/bows.h"
#include "clients/plugin/key_map.h"
#include "engine/microtuning/played_tuning.h"
#include "server/session/held_keys.h"
#include "server/session/registered_parameters.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

namespace ringdown::plugin {

inline constexpr std::uint8_t kTuneKeyHigh = 0xf4, kTuneKeyLow = 0xf5;
inline constexpr double kTuning_semitones = 120;  // maximum bend up and down
constexpr int tuning_code(double semitones) {
  return semitones <= -kTuning_semitones
             ? 0
             : (semitones >= kTuning_semitones ? 16383
                                               : static_cast<int>(8192.5 + semitones * 8191 / kTuning_semitones));
}
constexpr double tuning_of(int code) { return (code - 8192) * kTuning_semitones / 8191; }

class Keyboard {
 public:
  struct Playing {
    ringdown_mixer* mixer;
    std::int64_t frame;
    const KeyMap& map;
    const ParameterValues& parameters;
    const PlacedSizes& sizes;
  };
  // Plays one message at playing.frame. Ignores messages that are not MIDI or not played.
  void play(std::span<const std::uint8_t> message, const Playing& playing) REALTIME;

  // Call before the messages of a block: libringdown accepts a limited number of events per block, and would allocate a
  // sentence for each one that it refuses.
  void begin_block() REALTIME { events_left_ = kMaxEvents; }

  // Forgets keys, pedals, controllers, bends and pressure. Tunings stay.
  void reset() REALTIME;

  // The tuning of the keys, whose base the worker sets.
  [[nodiscard]] microtuning::PlayedTuning& tuning() { return tuning_; }

  // The worker reads from these functions how each key's object should be retuned. [any]
  // The pitch of the key above equal temperament, by its tuning and by bends.
  [[nodiscard]] double bend_semitones(std::size_t key) const REALTIME {
    return bend_semitones_[key].load(std::memory_order_relaxed) + tuning_.semitones(key);
  }
  [[nodiscard]] double pressure(std::size_t key) const REALTIME {  // 0 ... 1
    return pressure_[key].load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kMaxEvents = 3900;
  static constexpr std::size_t kForNotes = 1024;  // events that changes of bows leave to notes and their ends
  static constexpr std::size_t kNone = ~std::size_t{0};
  struct Channel {
    double bend = 0;              // -1 ... 1
    double hardness = 0;          // from controller 74, -1 ... 1
    double range_semitones = -1;  // of a full bend, by the registered parameter 0; below 0: not stated
  };
  void press(std::size_t key, std::size_t channel, std::uint8_t velocity, const Playing& playing) REALTIME;
  void tune_key(std::span<const std::uint8_t> message, const Playing& playing) REALTIME;
  void release(std::size_t key, std::size_t channel, const Playing& playing) REALTIME;
  void control(std::size_t channel, std::uint8_t number, std::uint8_t value, const Playing& playing) REALTIME;
  void set_registered(std::size_t channel, session::RegisteredParameters::Setting set, const Playing& playing) REALTIME;
  [[nodiscard]] std::size_t master_of(std::size_t channel, const Playing& playing) const REALTIME;
  [[nodiscard]] bool is_master(std::size_t channel, const Playing& playing) const REALTIME;
  [[nodiscard]] double range_semitones(std::size_t channel, const Playing& playing) const REALTIME;
  void reset_controllers(std::size_t channel, const Playing& playing) REALTIME;
  void bend(std::size_t channel, double bend, const Playing& playing) REALTIME;
  void bend_key(std::size_t key, const Playing& playing) REALTIME;
  void press_harder(std::size_t channel, double pressure, const Playing& playing) REALTIME;
  void press_key_harder(std::size_t key, double pressure, const Playing& playing) REALTIME;
  [[nodiscard]] bool follows(std::size_t key, std::size_t channel, const Playing& playing) const REALTIME;
  void damp(std::size_t key, double within_s, const Playing& playing) REALTIME;
  void damp_released(const session::HeldKeys::Keys& keys, const Playing& playing) REALTIME;
  void damp_all(double within_s, const Playing& playing) REALTIME;
  [[nodiscard]] bool kept(std::uint32_t object, const KeyMap& map) const REALTIME;

  void strike(std::size_t key, std::size_t channel, std::uint8_t velocity, const Playing& playing) REALTIME;
  void lift(std::size_t key, const Playing& playing) REALTIME;
  void clear(std::uint32_t object, double within_s, const Playing& playing) REALTIME;
  [[nodiscard]] bool takes_event() REALTIME {
    if (events_left_ == 0) return false;
    --events_left_;
    return true;
  }

  // Returns whether the key's bow may change.
  [[nodiscard]] bool takes_change(std::size_t key) REALTIME {
    return bows_.is_drawn(key) && events_left_ > kForNotes && takes_event();
  }

  std::size_t events_left_ = kMaxEvents;
  session::HeldKeys keys_;
  session::RegisteredParameters registered_;
  microtuning::PlayedTuning tuning_;
  std::array<std::size_t, 2> members_{};  // channels of MPE's lower and upper zone, as its configuration message states
  Bows bows_;
  int tuning_high_ = 64;                    // first half of a single key's tuning that is arriving
  std::array<double, kKeys> key_tuning_{};  // [semitones] bends of single keys
  std::array<Channel, session::midi::kChannels> channels_;
  std::array<std::uint8_t, kKeys> channel_of_{};  // channel that last played the key
  std::array<std::atomic<double>, kKeys> bend_semitones_{}, pressure_{};
};

}  // namespace ringdown::plugin
