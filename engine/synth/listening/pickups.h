// Pickups: outputs that carry the motion of one place of an object, as a contact microphone or a laser vibrometer
// would.
//
// A pickup lies on one object from its event's frame on, until one of the same number lies elsewhere, it is removed, or
// the object is gone. It does not care for the object's gain, pan or place: it feels the sum of the modes' shapes at
// its point times their displacement, velocity or acceleration, in every sample and however the sound is rendered
// (modes/probes.h). What rings out of an older bank of the object is felt, too, as long as no third bank has come.
//
// There is a fixed number of places for pickups, which the audio thread takes and gives back. [audio, after
// construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/modes/chunk.h"
#include "engine/synth/modes/voice.h"

#include <array>
#include <cstddef>
#include <span>

namespace ringdown::synth {

class PickupSlots;

// One place on one object.
struct Pickup {
  // The gains of the modes of one of the object's voices.
  struct Gains {
    const Voice* voice = nullptr;
    AlignedArray<float> re = aligned_zeros<float>(kMaxProbedColumns), im = aligned_zeros<float>(kMaxProbedColumns);
    double largest = 0;
  };
  verb::Pickup how;
  Frame begin = 0, end = kNever;  // it feels from `begin` on, up to `end`
  PickupSlots* owner = nullptr;   // the pickups of its object; null: it is free
  std::array<Gains, 2> gains;     // of the object's current voice, and of the newest that rings out
  std::array<double, kChunkFrames> samples{};

  [[nodiscard]] std::size_t channel() const REALTIME { return kFirstPickup + how.number - 1; }
};

// The pickups of one object, in a chunk: begin(), then listen() before everything that is rendered, then end().
class PickupSlots {
  friend class Pickups;

 public:
  [[nodiscard]] bool any() const REALTIME { return count_ > 0; }
  void begin(const Chunk& chunk) REALTIME;
  // Lets the voices feel what they render next, from frame `offset` of the chunk on.
  void listen(std::size_t offset, const Chunk& chunk, const VoiceStack& voices, Workspace& workspace) REALTIME;
  // Adds what was felt to the outputs; samples that cannot be motion are counted and left out.
  void end(const Chunk& chunk, const VoiceStack& voices, Workspace& workspace) REALTIME;
  // Returns the factor on the amplitude below which modes rest: modes that are hardly heard may still be felt.
  [[nodiscard]] double floor_factor() const REALTIME;

 private:
  [[nodiscard]] std::span<Pickup* const> all() const REALTIME { return {slots_.data(), count_}; }

  std::array<Pickup*, kMaxProbes> slots_{};
  std::size_t count_ = 0;
};

class Pickups {
 public:
  // Carries out the verb on the object of these slots and voices. Returns false if it asks for what cannot be: a number
  // that no pickup has, an object of too many modes, or a removal where there is nothing.
  [[nodiscard]] bool set(const verb::Pickup& how, Frame frame, PickupSlots& slots, const VoiceStack& voices) REALTIME;
  // Finds the gains anew after an object's voices have changed.
  static void refit(PickupSlots& slots, const VoiceStack& voices) REALTIME;
  // Gives back the pickups that are over at a frame, or all those of an object.
  void drop_finished(Frame frame) REALTIME;
  void leave(PickupSlots& slots) REALTIME;

 private:
  void drop(Pickup& pickup) REALTIME;

  std::array<Pickup, kMaxProbes> pickups_;
  std::size_t used_ = 0;  // pickups that are not free
};

}  // namespace ringdown::synth
