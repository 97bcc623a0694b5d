// A chunk, up to kChunkFrames frames that are rendered in one go: its shared input for all rendering threads, and each
// thread's own buffers.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/channel_sums.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "engine/synth/modes/mode_states.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class Listening;
class Shedding;
struct MixerCounters;

// Constant while the chunk is rendered.
struct Chunk {
  Frame begin = 0;
  std::size_t frames = 0;
  double sample_rate_hz = 0;
  double floor = 0;                             // amplitude at full gain below which modes rest
  bool moments = false;                         // slow modes are summed as moments, not by tables
  ChannelSet wanted = 0;                        // channels that are listened to
  Inputs inputs{};                              // buffers at the chunk's first frame
  std::array<bool, kMaxInputs> input_sounds{};  // which inputs are not silent in this chunk
  const Shedding* shedding = nullptr;
  MixerCounters* counters = nullptr;
  const Listening* listening = nullptr;  // null: there has never been a listener
  double look_pressure = 1;              // factor by which maps are looked up less often than ideal (placement.h)

  [[nodiscard]] Frame end() const REALTIME { return begin + static_cast<Frame>(frames); }
  // The cell in which the chunk lies if there is a listener (Timeline). Moving things are evaluated at the boundaries
  // of cells, which do not depend on the size of blocks.
  [[nodiscard]] Frame cell_begin() const REALTIME { return begin - begin % static_cast<Frame>(kChunkFrames); }
  [[nodiscard]] Frame cell_end() const REALTIME { return cell_begin() + static_cast<Frame>(kChunkFrames); }
};

// Counts of what sounds in a chunk, for status and for the next chunk's choices.
struct ChunkCounts {
  std::uint32_t voices = 0, modes = 0, muted_modes = 0;
  std::size_t slow_modes = 0;        // number of `modes` that take moments
  double units = 0;                  // units of work (work_cost.h)
  double enter_units = 0;            // units spent on muted modes that came back
  double look_terms = 0;             // terms of maps, if gains in directions were found as often as exactness requires
  std::uint32_t coupled_voices = 0;  // voices whose modes exchange energy
  float psi_error = 0;               // psi over its true value, less 1: the largest in size among these voices
  bool shed = false;                 // whether something was left out for lack of time

  void add(const ChunkCounts& other) REALTIME {
    voices += other.voices;
    modes += other.modes;
    muted_modes += other.muted_modes;
    slow_modes += other.slow_modes;
    units += other.units;
    enter_units += other.enter_units;
    look_terms += other.look_terms;
    coupled_voices += other.coupled_voices;
    note_psi(other.psi_error);
    shed = shed || other.shed;
  }
  void note_psi(float error) REALTIME {
    if (std::abs(error) > std::abs(psi_error)) psi_error = error;
  }
  void add(const ModeStates::Counts& states) REALTIME {
    modes += static_cast<std::uint32_t>(states.sounding);
    muted_modes += static_cast<std::uint32_t>(states.muted);
    slow_modes += states.slow;
  }
};

// The buffers and counters with which one thread renders.
struct Workspace {
  ChannelSums sums;
  ChunkCounts counts;
  alignas(64) std::array<double, kChunkFrames> mono{};                              // one object's samples
  alignas(64) std::array<std::array<double, kChunkFrames>, kMaxForces> impulses{};  // of the forces on one object
  AlignedArray<double> spare = aligned_zeros<double>(2 * kMaxProbedColumns);        // a copy of one voice's states
  // Set by Shedding before each source:
  Level threshold = kNoThreshold;  // modes below this level are muted
  bool at_once = false;            // mute without a ramp
  double units_before = 0;         // counts.units before rendering began
  double enter_units = 0;          // units that entering modes may still cost in this chunk
  std::size_t allowance = 0;       // number of the source's muted modes that may enter
  double coupled_units = 0;        // units that modes about to exchange energy may begin
  bool recovers = false;           // whether there is enough time to bring back modes cut short
};

}  // namespace ringdown::synth
