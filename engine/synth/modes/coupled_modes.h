// The build-up of a gong: its lowest modes exchange energy, and their equations are solved sample by sample.
//
//   q_m'' + 2 d_m q_m' + omega_m^2 q_m + dV/dq_m = 0,     V = sum over k of [ (g_k . q) t_k + 1/2 t_k^2 ]
//
// Each mode keeps its exact pole: q+ = 2 Re(p) q - |p|^2 q- - d V'. V is handled by a scalar auxiliary variable
// psi = sqrt(2 V + C), which makes an explicit step that cannot gain energy (Shen, Xu & Yang, J. Comput. Phys. 353,
// 2018; Bilbao, Ducceschi & Zama, J. Comput. Phys. 486, 2023): with g = V'/sqrt(2 V + C) the sum of the modes' discrete
// energies and psi^2 / 2 is kept to rounding where nothing is lost. Two things keep psi at its true value: C is many
// times the energy, and a term along the velocity moves energy between psi and the modes without changing the sum.
//
// The states z of the mixer and the displacements are two views of one motion: q = Re z / (output per displacement),
// and the displacement one sample ago is that of z / p. So modes come and go without a click.
//
// A mode is heard by its acceleration. For one that rings alone this is -omega^2 q, which the states say; here the
// force of the others is added, or a shell that its vibration has bent inward would sound a constant. Where forces
// begin or end, what they gave at last fades away in 2 ms.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/material_scale.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/coupled_kernel.h"
#include "engine/synth/modes/probes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::synth {

class ModeTable;

inline constexpr std::size_t kMaxCoupledModes = 64, kMaxCoupledFunctions = 60;  // in real time

// Data that all voices of a table share.
struct CoupledTable {
  std::vector<std::uint32_t> columns;    // of the M modes
  std::vector<double> pole_re, pole_im;  // M: per frame
  std::vector<double> output;            // M: output per displacement
  std::vector<double> detuning;          // M: the most that |z|^2 = 1 of the mode detunes any, relative (GlideMatrix)
  std::vector<std::int32_t> gliding;     // M: which of the table's gliding modes it is, or -1
  AlignedArray<float> bending, curving;
  CoupledArrays arrays;
  double frame_s = 0;
  double units_per_frame = 0;  // of work (work_cost.h)

  // At most `max` modes, the lowest; nothing where the bank asks for none (modal::NonlinearTerms::coupled). [worker]
  static std::shared_ptr<const CoupledTable> of(const ModeTable& table, const modal::MaterialScale& material,
                                                const std::vector<double>& output_per_velocity, std::size_t max);
};

class CoupledModes {
 public:
  // At rest. The table outlives it. [worker]
  explicit CoupledModes(const CoupledTable& table);

  // From here on: [audio]
  [[nodiscard]] bool running() const REALTIME { return running_; }

  // Returns the relative detuning of its modes by each other, from the mixer's states and its own.
  [[nodiscard]] double strength(const double* re, const double* im) const REALTIME;

  // Takes what rings in its modes' states, which become zero.
  void take(double* re, double* im) REALTIME;
  // Adds `frames` <= kChunkFrames samples to `out` and moves on. False when a state or a sample is absurd
  // (kAbsurdEnergy, kAbsurdSample): nothing was added then, and the modes have come to rest.
  // `probes` feel its modes, too.
  bool render(double* out, std::size_t frames, std::span<const Probes::One> probes = {}) REALTIME;
  // While it is at rest: adds what is left of the forces' sound, or cuts it off.
  void fade(double* out, std::size_t frames) REALTIME;
  void cut_off() REALTIME { forced_ = fading_ = 0; }
  // Gives everything back to the states and comes to rest.
  void give_back(double* re, double* im) REALTIME;

  // The sum of its modes' amplitudes at the output.
  [[nodiscard]] double amplitude() const REALTIME;
  // Adds |z|^2 of its modes to those of the table's gliding modes.
  void add_squares(float* squares) const REALTIME;
  // The energy of its modes [J], that of psi included; and psi over its true value at the last sample.
  [[nodiscard]] double energy_j() const REALTIME;
  [[nodiscard]] double psi_over_truth() const REALTIME { return psi_over_truth_; }
  [[nodiscard]] double units_per_frame() const REALTIME { return table_.units_per_frame; }

 private:
  [[nodiscard]] double state_im(std::size_t m) const REALTIME;
  [[nodiscard]] double linear_energy() const REALTIME;
  double potential_at_middle() REALTIME;
  double step() REALTIME;

  const CoupledTable& table_;
  std::size_t modes_;
  std::vector<double> now_, before_;                // q of this sample and of the last one
  std::vector<double> turn_, keep_, push_, stiff_;  // 2 Re p, |p|^2, 2 k^2 / (1 + |p|^2), discrete omega^2
  std::vector<double> per_force_;                   // output per force
  AlignedArray<float> place_, gradient_;            // q as the kernel wants it, padded
  double psi_ = 0, shift_ = 0, psi_over_truth_ = 1;
  double forced_ = 0, fading_ = 0;  // the forces' sound at the last sample, and what fades of an earlier one
  bool running_ = false, taken_ = false;
};

// A voice's coupled modes, if its table has any: when they run. [audio, after construction]
class Coupling {
 public:
  explicit Coupling(const ModeTable& table);

  [[nodiscard]] bool possible() const REALTIME { return modes_ != nullptr; }
  [[nodiscard]] bool running() const REALTIME { return modes_ && modes_->running(); }
  [[nodiscard]] double amplitude() const REALTIME { return running() ? modes_->amplitude() : 0.0; }
  void add_squares(float* squares) const REALTIME {
    if (running()) modes_->add_squares(squares);
  }
  [[nodiscard]] double psi_over_truth() const REALTIME { return running() ? modes_->psi_over_truth() : 1.0; }
  // The work of `frames` samples while it runs (work_cost.h).
  [[nodiscard]] double units(std::size_t frames) const REALTIME {
    return modes_ ? modes_->units_per_frame() * static_cast<double>(frames) : 0.0;
  }
  // False if there is no time for it: then it ends, or does not begin.
  bool affordable = true;

  // Takes over what rings in the states while that is loud enough and `allowed`, and adds its sound to `out`; else
  // gives it back, and says `ended` when it did.
  enum class Outcome : std::uint8_t { nothing, rendered, ended, absurd };
  Outcome render(double* re, double* im, bool allowed, double* out, std::size_t frames,
                 std::span<const Probes::One> probes = {}) REALTIME;
  void cut_off() REALTIME {
    if (modes_) modes_->cut_off();
  }
  // True when something was given back, whose modes are to sound from the states again.
  bool give_back(double* re, double* im) REALTIME;

 private:
  std::unique_ptr<CoupledModes> modes_;
};

}  // namespace ringdown::synth
