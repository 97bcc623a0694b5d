// Thin objects glide: the harder they were struck, the higher (or lower) they sound until they have calmed down.
//
// Each chunk, mode m of a bank with nonlinear terms turns by delta_m per frame faster than it would alone, where
// delta_m follows from all amplitudes (modal/nonlinear.h: detuning). Only phases are moved: amplitudes, decay and
// energy stay as they are. To second order x = 2 delta / omega = sum of 2 B_ml v_l^2 / (omega_l^2 omega_m), with v_l a
// mode's velocity. A mode that stiffens moves less far at the same energy, so that this x0 becomes
//
//   x = 3/4 (sqrt(1 + 8/3 x0) - 1),   omega' = omega sqrt(1 + x)
//
// which is harmonic balance of Duffing's oscillator at given energy, and agrees to first order.
//
// The matrix belongs to the table that voices share; a Glide is one voice's, with poles and tables of its own that the
// kernels are given in place of the table's as soon as a mode is detuned by more than kMinDetuning.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/material_scale.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/mode_kernel.h"
#include "engine/synth/kernels/moments.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace ringdown::synth {

class ModeTable;

inline constexpr std::size_t kMaxGlidingModes = 100;  // the lowest; M^2 numbers, and 8 M^3 bytes while a table is made
inline constexpr float kMinDetuning = 1e-5F;          // relative: 0.017 cents

// A mode that is played and has nonlinear terms.
struct GlidingMode {
  double omega_rad_s;          // undamped
  std::size_t mode, playable;  // its number in the bank and in the table
};

// The detuning of each mode by each gliding mode, by a table's columns.
struct GlideMatrix {
  std::vector<std::uint32_t> columns;  // of the n gliding modes
  std::vector<float> reach;            // n: the most that a state z_l of 1 detunes any mode [relative]
  // By how much it detunes mode m, of reach / 127, by blocks of kModePadding m: first their l = 0. In one byte each,
  // because a call that looks at pitches takes most of its time to get these from memory; what is rounded off is at
  // most 0.4 % of what all modes can reach.
  std::vector<std::int8_t> shares;
  std::vector<float> bend;  // n: (largest deflection / thickness)^2 at |z| = 1; 0 where it is not known

  // x0 of the gliding modes from kModePadding * `block` on, of which there may be fewer, for these n reach |z|^2.
  std::array<float, kModePadding> detuned(std::size_t block, const float* reached) const REALTIME;

  // Nothing where the bank has no terms or none of their modes is played. `output_per_velocity` has one number for each
  // playable mode of the table. [worker]
  static std::shared_ptr<const GlideMatrix> of(const ModeTable& table, const modal::MaterialScale& material,
                                               const std::vector<double>& output_per_velocity);

  // The lowest modes with terms, at most `max`, ascending; those that make no sound are left out. [worker]
  static std::vector<GlidingMode> lowest(const ModeTable& table, const modal::MaterialScale& material,
                                         const std::vector<double>& output_per_velocity, std::size_t max);
};

// x from x0, as above, at least -1/2.
double stiffened(double x0) REALTIME;

class Glide {
 public:
  // The table outlives it and has a matrix. [worker]
  explicit Glide(const ModeTable& table);

  // From here on: [audio]

  // Looks at the states before a call renders `moments` or tables, and finds the pitches anew where they have changed.
  // When the sound grows all modes are looked at, else a few groups at a time, more while pitches move fast; where they
  // hardly move, few calls look. How fast they move is what they were seen to do in the last round, beside the sum of
  // what each mode that fades could do.
  void follow(const double* re, const double* im, bool moments) REALTIME;
  // The states have been added to: the next call looks.
  void excite() REALTIME { wait_ = 0; }

  [[nodiscard]] bool active() const REALTIME { return active_; }
  // Gives a kernel the moved poles and tables for a call of `frames`. While active().
  void apply(ModeArrays& modes, std::size_t frames) const REALTIME;
  [[nodiscard]] MomentArrays moments() const REALTIME { return {band_.data(), weights_.get()}; }
  [[nodiscard]] std::pair<const double*, const double*> exponents() const REALTIME {
    return {row(exponent_re), row(exponent_im)};
  }

 private:
  enum Row { pole_re, pole_im, full_re, full_im, exponent_re, exponent_im, kRows };
  [[nodiscard]] double* row(Row which) const REALTIME { return rows_.get() + which * columns_; }
  // Columns of modes whose constants change together.
  struct Moving {
    std::array<std::uint32_t, kModePadding> columns{};
    std::size_t count = 0;
  };
  void look_at_block(std::size_t block, bool anew) REALTIME;
  void share_band(std::size_t group) REALTIME;
  void move(const Moving& moving) REALTIME;
  void weigh(const Moving& moving) REALTIME;

  // The members that every call reads stand first, in as few cache lines as possible.
  std::uint32_t wait_ = 0, waited_ = 0;  // calls until the next look, and from the last one to it
  bool active_ = false, moments_ = false;
  std::size_t columns_;
  AlignedArray<double> rows_;  // kRows x columns
  AlignedArray<float> strides_, runs_, weights_;
  std::vector<std::uint16_t> band_;
  const ModeTable& table_;
  const GlideMatrix& matrix_;
  std::vector<float> reached_;        // reach |z|^2 of the gliding modes
  std::vector<double> delta_;         // of each column [rad/frame]
  float due_ = 0;                     // looks at blocks
  float total_ = 0;                   // by how much modes could be detuned [relative], at the last look
  float could_move_ = 0, moved_ = 0;  // in this round of looks: the sum of that, and the most that any mode moved
  float share_ = 1;                   // the one over the other, in the last round
  std::size_t next_ = 0;              // block of the matrix
};

}  // namespace ringdown::synth
