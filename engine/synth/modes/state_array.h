// The states of a table's modes, as numbers: one complex z for each column. What sounds of them is decided elsewhere
// (mode_states.h). [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/mode_transfer.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/modes/glide.h"
#include "engine/synth/modes/mode_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace ringdown::synth {

// A complex gain for each column.
struct ModeFactors {
  const float *re = nullptr, *im = nullptr;
};

// The amplitudes that a blow gives the modes, one per column: a mode begins as re sin(omega t) + im cos(omega t).
struct BlowAmplitudes {
  const double* re;
  const double* im = nullptr;  // null: all 0, as after a strike, which moves no point at once
};

class StateArray {
 public:
  // All zero. The table outlives the array. [worker]
  explicit StateArray(const ModeTable& table) : table_(table), numbers_(aligned_zeros<double>(2 * table.columns())) {}

  [[nodiscard]] const ModeTable& table() const REALTIME { return table_; }
  [[nodiscard]] double* re() const REALTIME { return numbers_.get(); }
  [[nodiscard]] double* im() const REALTIME { return numbers_.get() + table_.columns(); }

  // The states with all that the kernels need for a call of `frames`.
  [[nodiscard]] ModeArrays for_kernel(std::size_t frames) const REALTIME {
    ModeArrays modes = table_.modes(re(), im(), frames);
    modes.hearing = hearing_;
    if (glide_ && glide_->active()) glide_->apply(modes, frames);
    return modes;
  }
  [[nodiscard]] MomentArrays moments() const REALTIME {
    return glide_ && glide_->active() ? glide_->moments() : table_.moments();
  }
  [[nodiscard]] std::pair<const double*, const double*> exponents() const REALTIME {
    return glide_ && glide_->active() ? glide_->exponents() : table_.exponents();
  }
  // Lets amplitudes move pitches, where the table's bank says how (glide.h). [worker]
  void let_glide() {
    if (table_.glide) glide_.emplace(table_);
  }
  // Before each call that renders.
  void follow(bool moments) REALTIME {
    if (glide_) glide_->follow(re(), im(), moments);
  }
  // After states have been written by others than this array.
  void excited() REALTIME {
    if (glide_) glide_->excite();
  }
  // By what gains the modes are heard in kernels; null: each by 1. It outlives the array.
  void hear_by(const Hearing* hearing) REALTIME { hearing_ = hearing; }

  // Adds a blow's amplitudes (ModeTable::strike), one per column, times `gain`. A struck mode begins as a sine:
  // a sin(omega t) = Re(-i a exp(i omega t)), so a strike lowers the imaginary part of z.
  // With `each`, every mode is multiplied by a gain of its own as well.
  void add_strike(BlowAmplitudes blow, double gain, const ModeFactors* each = nullptr) REALTIME;
  void add_strike(BlowAmplitudes blow, double gain, std::uint32_t group, const ModeFactors* each = nullptr) REALTIME;

  // Adds the states of another array of the same table, times `gain`, and times `each`.
  void add(const StateArray& other, double gain, const ModeFactors* each = nullptr) REALTIME;
  void add(const StateArray& other, double gain, std::uint32_t group, const ModeFactors* each = nullptr) REALTIME;

  // Moves the states of `other`, of the same bank in another table, that have a column here; every other column becomes
  // zero. True when states without a column here are left in `other`.
  bool move_from(StateArray& other) REALTIME;
  // Moves all states of `other`, whose bank is that of the same object before it changed: `change` says what becomes of
  // each mode. Modes that are not playable are taken to be at rest.
  void move_from(StateArray& other, const modal::ModeTransfer& change) REALTIME;

  // Moves all states, or those of one group, on by `frames`, however many: z *= p^frames.
  void skip(std::uint64_t frames) REALTIME;
  void skip(std::uint64_t frames, std::uint32_t group) REALTIME;

  void clear() REALTIME;
  void clear(std::uint32_t group) REALTIME;

  // The sum of a group's |z|^2; not a number, or huge, where one of them is.
  [[nodiscard]] double energy(std::uint32_t group) const REALTIME;
  // The sum of |z| over a group, or over all columns.
  [[nodiscard]] double amplitude(std::uint32_t group) const REALTIME;
  [[nodiscard]] double amplitude() const REALTIME;

 private:
  void add_strike(BlowAmplitudes blow, double gain, std::size_t first, std::size_t end,
                  const ModeFactors* each) REALTIME;
  void add(const StateArray& other, double gain, std::size_t first, std::size_t end, const ModeFactors* each) REALTIME;

  const ModeTable& table_;
  AlignedArray<double> numbers_;  // real parts of all columns, then imaginary parts
  const Hearing* hearing_ = nullptr;
  std::optional<Glide> glide_;  // nothing: pitches are the table's
};

}  // namespace ringdown::synth
