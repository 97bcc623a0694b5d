// Gives the objects that notes strike the sizes in which they have the pitches of the keyboard's tuning. [worker]
//
//   NoteTuner tuner(rack, tuning, map);
//   tuner.catch_up();                            // several times a second
//
// A key's tuning is a deviation from equal temperament, and so much higher or lower than in its own size its object
// sounds: frequencies are exactly proportional to 1 / size. If several notes strike an object, the lowest counts.
#pragma once

#include "engine/microtuning/mts_esp.h"
#include "engine/microtuning/played_tuning.h"
#include "server/session/note_map_file.h"
#include "server/session/rack.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace ringdown::session {

class NoteTuner {
 public:
  // `tuning` is what MIDI's messages change. Its base is the map's own tuning; for maps without one, and without a map,
  // the tuning of MTS-ESP's master while there is one.
  NoteTuner(Rack& rack, microtuning::PlayedTuning& tuning, std::optional<NoteMap> map)
      : rack_(rack), tuning_(tuning), map_(std::move(map)) {}

  // Retunes every object whose pitch has changed, and objects that are new.
  void catch_up();

 private:
  using Pitches = std::array<double, kNotes>;
  [[nodiscard]] Pitches read_pitches();
  [[nodiscard]] bool retune(const ObjectState& object, double semitones);

  Rack& rack_;
  microtuning::PlayedTuning& tuning_;
  const std::optional<NoteMap> map_;
  microtuning::MtsEsp mts_esp_;
  Pitches pitches_{};                          // those of the last round
  std::uint64_t version_ = ~std::uint64_t{0};  // of the rack in the last round
};

}  // namespace ringdown::session
