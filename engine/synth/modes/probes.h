// Hears the motion of places of the surface beside the sound: what a pickup needs of one voice (listening/pickups.h).
//
// A probe is a complex gain for each column. A mode of state z moves its place by Re(gain z), so that a probe's samples
// are what the kernels compute for a listener whom modes reach by these gains. They are computed on a copy of the
// states before these are moved on; nothing of the sound changes. A probe costs some 6 units for a mode and chunk
// (work_cost.h), less than a strike. [audio, after construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/drive_kernel.h"
#include "engine/synth/kernels/mode_kernel.h"
#include "engine/synth/modes/state_array.h"

#include <array>
#include <cstddef>
#include <span>

namespace ringdown::synth {

inline constexpr std::size_t kMaxProbes = 2 * kMaxPickups;  // of a voice: in one chunk pickups may leave and come
inline constexpr std::size_t kMaxProbedColumns = 4096;      // of a voice's modes; with more, nothing is probed

class Probes {
 public:
  struct One {
    const float *gain_re = nullptr, *gain_im = nullptr;  // of each column, 64-byte aligned
    double* to = nullptr;                                // the samples of the next call are added there
  };

  // `spare` is room for 2 x kMaxProbedColumns numbers, 64-byte aligned, for as long as there are probes.
  void begin(double* spare) REALTIME {
    spare_ = spare;
    count_ = 0;
  }
  void add(const One& one) REALTIME { probes_[count_++] = one; }
  void clear() REALTIME { count_ = 0; }
  [[nodiscard]] std::span<const One> all() const REALTIME { return {probes_.data(), count_}; }

  // Each of these adds what all probes feel in the next `frames` <= kChunkFrames, before the states are moved on.

  // Groups that ring freely.
  void ring(const StateArray& states, ActiveGroups groups, std::size_t frames) const REALTIME;
  // All columns, under forces (drive_modes()).
  void drive(const StateArray& states, std::span<const Force> forces, std::size_t frames) const REALTIME;
  // All columns, while something touches the object (drive_touched()). `modes` has the poles of a step.
  void touch(const StateArray& states, const ModeArrays& modes, std::span<const Force> forces, const PortForces& ports,
             std::size_t frames, std::size_t substeps) const REALTIME;

  // Adds what one probe feels of groups that ring freely to `out`.
  void ring(const One& probe, const StateArray& states, ActiveGroups groups, double* out,
            std::size_t frames) const REALTIME;

 private:
  std::array<One, kMaxProbes> probes_;
  std::size_t count_ = 0;
  double* spare_ = nullptr;
};

}  // namespace ringdown::synth
