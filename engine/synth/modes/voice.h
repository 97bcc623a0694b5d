// One bank ringing at one sample rate in one material, for one object.
//
// The worker builds a voice and gives it to the mixer; from then on only the audio thread touches it, until the mixer
// hands it back to be freed.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"
#include "engine/synth/modes/mode_states.h"
#include "engine/synth/modes/mode_table.h"

#include <memory>
#include <optional>
#include <span>
#include <type_traits>

namespace ringdown::synth {

struct MixerCounters;

class Voice : public ModeStates {
 public:
  // A voice of a table that it may share with other voices, or of a table of its own. [worker]
  explicit Voice(std::shared_ptr<ModeTable> table);
  Voice(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz);

  // Adds a verb that excites() at the current frame; the second form adds it as a late strike, `frames_left` before the
  // end of the chunk. Counts in `counters` when it was limited (blow_limit.h). False when the vertex does not exist.
  // [audio]
  template <class Blow>
  bool strike(const Blow& blow, MixerCounters* counters = nullptr) REALTIME {
    const std::optional<double> energy = find_amplitudes(blow);
    if (energy) add(amplitudes(), gain_for(*energy, counters));
    return energy.has_value();
  }
  template <class Blow>
  bool strike_late(const Blow& blow, std::size_t frames_left, MixerCounters* counters = nullptr) REALTIME {
    const std::optional<double> energy = find_amplitudes(blow);
    if (energy) add_late(amplitudes(), gain_for(*energy, counters), frames_left);
    return energy.has_value();
  }

  // Finds the amplitude that a strike gives each mode, for amplitudes(), and returns the sum of their squares; nullopt
  // when the vertex does not exist. [audio]
  template <class Blow>
  [[nodiscard]] std::optional<double> find_amplitudes(const Blow& blow) REALTIME {
    displaced_ = std::is_same_v<Blow, verb::Impart>;
    return table_->strike(blow, scratch(), amplitudes_.get());
  }
  // As above, and false when the amplitudes are absurd, too (kAbsurdEnergy). [audio]
  template <class Blow>
  [[nodiscard]] bool find_sane_amplitudes(const Blow& blow) REALTIME {
    const std::optional<double> energy = find_amplitudes(blow);
    return energy && *energy <= kAbsurdEnergy;
  }
  // The last result of find_amplitudes(). [audio]
  [[nodiscard]] BlowAmplitudes amplitudes() const REALTIME {
    return {amplitudes_.get(), displaced_ ? amplitudes_.get() + table_->columns() : nullptr};
  }

  // As ModeTable::find_motion(). [audio]
  double find_motion(const verb::Pickup& pickup, float* re, float* im) REALTIME {
    return table_->find_motion(pickup, scratch(), re, im);
  }

  // A new voice with another table of the same bank, which takes over what rings in this one. [worker, while nothing
  // renders either]
  [[nodiscard]] std::unique_ptr<Voice> with_table(std::shared_ptr<ModeTable> table);

  [[nodiscard]] ModeTable& table() const REALTIME { return *table_; }
  [[nodiscard]] const std::shared_ptr<ModeTable>& shared_table() const { return table_; }

  Voice* next = nullptr;  // in a list of voices, which must not allocate

  // What becomes of the modes of the voice before, if the object has changed between the two; else null. [worker,
  // before the voice is installed]
  std::shared_ptr<const modal::ModeTransfer> mode_change;

 private:
  // One number for each mode of the bank.
  [[nodiscard]] std::span<double> scratch() const REALTIME {
    return {amplitudes_.get() + table_->columns(), table_->bank().mode_count()};
  }
  // The factor on a strike's amplitudes, whose squares add up to `energy`.
  [[nodiscard]] double gain_for(double energy, MixerCounters* counters) const REALTIME;

  std::shared_ptr<ModeTable> table_;
  // BlowAmplitudes: re of all columns, then im, which counts if displaced_. A blow that leaves im alone uses its place.
  AlignedArray<double> amplitudes_;
  bool displaced_ = false;
};

// An object's voices: the current one, which takes strikes, and older ones that ring out.
class VoiceStack {
 public:
  [[nodiscard]] Voice* current() const REALTIME { return current_; }
  [[nodiscard]] bool has_tails() const REALTIME { return tails_ != nullptr; }

  // Makes `voice`, or none, the current one. With `retune` it takes over what rings of its modes in the old one, whose
  // other modes fade out; otherwise the old one rings out.
  void replace(Voice* voice, bool retune) REALTIME;
  void fade_out(const Fading& fade) REALTIME;
  // Takes silent tails off, oldest last, and hands each to `retire(voice, last)`; `last` tells that the object has no
  // voice any more.
  template <class Retire>
  void drop_silent_tails(const Retire& retire) REALTIME {
    for (Voice** link = &tails_; *link;) {
      Voice* const voice = *link;
      if (voice->ringing()) {
        link = &voice->next;
        continue;
      }
      Voice* const next = voice->next;
      const bool last = !current_ && !next && link == &tails_;
      *link = next;
      retire(voice, last);
    }
  }
  template <class Act>
  void for_each(const Act& act) const REALTIME {
    if (current_) act(*current_);
    for (Voice* voice = tails_; voice; voice = voice->next) act(*voice);
  }
  void free_all();  // [worker, while nothing is rendered]
  // Exchanges every voice for the one that `renew(voice)` returns. [worker, while nothing is rendered]
  template <class Renew>
  void renew(const Renew& renew) {
    if (current_) current_ = renew(current_);
    for (Voice** link = &tails_; *link; link = &(*link)->next) {
      Voice* const next = (*link)->next;
      *link = renew(*link);
      (*link)->next = next;
    }
  }

 private:
  Voice *current_ = nullptr, *tails_ = nullptr;
};

}  // namespace ringdown::synth
