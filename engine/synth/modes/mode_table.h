// The constants of a bank's modes at one sample rate in one material: poles, tables, moments' weights. Objects that
// sound alike share one table.
//
// Modes at or above Nyquist, over-damped ones, and those outside a range that may be given are left out. The others
// stand in columns: those that take moments first, each kind by frequency and padded with silent ones to whole groups
// of kModePadding.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/damper.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "engine/modal/strike_map.h"
#include "engine/synth/events/event.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/kernels/mode_kernel.h"
#include "engine/synth/kernels/moments.h"
#include "engine/synth/modes/click.h"

#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::synth {

struct GlideMatrix;
struct CoupledTable;

// Settings that all tables of a mixer share.
struct TableSettings {
  double full_scale_pa = modal::kFullScale_pa;  // a pressure of this at 1 m becomes an amplitude of 1
  std::size_t max_coupled = 64;                 // modes of a voice that may exchange energy (coupled_modes.h)
  bool field = false;                           // objects are heard in ambisonic channels
};

class ModeTable {
  friend class TouchGroup;

 public:
  // `dampers` are what lies on the object, `modes` those that it has. [worker]
  ModeTable(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz,
            modal::Dampers dampers = {}, modal::ModeRange modes = {}, const TableSettings& settings = {});

  // The same choice of modes, in the same material and under the same dampers, at another sample rate. [worker]
  [[nodiscard]] std::shared_ptr<ModeTable> at_rate(double sample_rate_hz) const {
    return std::make_shared<ModeTable>(map_, material_, sample_rate_hz, dampers_, modes_, settings_);
  }
  [[nodiscard]] double sample_rate_hz() const REALTIME { return sample_rate_hz_; }

  [[nodiscard]] bool is_of(const std::shared_ptr<const modal::StrikeMap>& map, const modal::MaterialScale& material,
                           const modal::Dampers& dampers = {}, modal::ModeRange modes = {}) const {
    return map == map_ && material == material_ && dampers == dampers_ && modes == modes_;
  }

  [[nodiscard]] const modal::Bank& bank() const REALTIME { return map_->bank(); }
  [[nodiscard]] std::size_t playable_modes() const REALTIME { return mode_of_.size(); }
  [[nodiscard]] std::size_t slow_modes() const REALTIME { return slow_modes_; }  // that take moments
  [[nodiscard]] std::size_t columns() const REALTIME { return columns_; }
  [[nodiscard]] std::size_t groups() const REALTIME { return columns_ / kModePadding; }
  [[nodiscard]] std::size_t slow_groups() const REALTIME { return slow_groups_; }

  // The column of mode `mode` of the bank; nullopt where it is not playable.
  [[nodiscard]] std::optional<std::size_t> column_of(std::size_t mode) const REALTIME;
  // The mode of the bank that is playable mode `i`, and its column.
  [[nodiscard]] std::size_t mode_of(std::size_t i) const REALTIME { return mode_of_[i]; }
  [[nodiscard]] std::size_t column(std::size_t i) const REALTIME {
    return i < slow_modes_ ? i : i + kModePadding * slow_groups_ - slow_modes_;
  }

  // The output of playable mode `i` at a modal velocity of 1.
  [[nodiscard]] double output_per_velocity(std::size_t i) const REALTIME { return weight_[i]; }

  // The least decay among the modes of a group [nepers per frame].
  [[nodiscard]] double slowest_decay(std::size_t group) const REALTIME { return slowest_decay_[group]; }

  // Finds the output amplitude that a strike gives the mode of each column, and returns the sum of their squares;
  // nullopt when the vertex does not exist. Points are in the frame of the object in its size. `scratch` has one
  // element per mode of the bank, `amplitudes` one per column; padding columns stay as they were. [audio]
  [[nodiscard]] std::optional<double> strike(const verb::Strike& strike, std::span<double> scratch,
                                             double* amplitudes) const REALTIME;
  [[nodiscard]] std::optional<double> strike(const verb::StrikeVertex& strike, std::span<double> scratch,
                                             double* amplitudes) const REALTIME;
  [[nodiscard]] std::optional<double> strike(const verb::Ring& ring, std::span<double> scratch,
                                             double* amplitudes) const REALTIME;
  // Nothing where the bank has no air with modes of its own.
  [[nodiscard]] std::optional<double> strike(const verb::Slap& slap, std::span<double> scratch,
                                             double* amplitudes) const REALTIME;
  // Writes 2 x columns() amplitudes: the sines of all columns, then the cosines (BlowAmplitudes).
  [[nodiscard]] std::optional<double> strike(const verb::Impart& impart, std::span<double> scratch,
                                             double* amplitudes) const REALTIME;

  // Finds by which complex gains the states of all columns move a place: Re(gain z) adds up to what the pickup feels.
  // `scratch` has one element per mode of the bank, `re` and `im` one per column. Returns the largest size of a gain. A
  // mode that radiates nothing has no state and moves nothing. [audio]
  double find_motion(const verb::Pickup& pickup, std::span<double> scratch, float* re, float* im) const REALTIME;

  // Finds what chunks of `frames` need, so that it is found once. [audio, while no other thread renders]
  void prepare(std::size_t frames) REALTIME;

  // In which directions the bank's modes are heard, and for each column the rank of its mode there and its frequency.
  // Padding columns have a rank of 0.
  [[nodiscard]] const modal::DirectionMap& directions() const REALTIME { return map_->directions(); }
  struct Columns {
    const std::uint32_t* ranks;
    const float* frequencies_hz;
    const float* tube_shares;  // of the sound that comes out of a tube (tube_bank.h); null when no mode has any
  };
  [[nodiscard]] Columns heard_columns() const REALTIME { return {rank_.data(), column_hz_.get(), tube_shares_.get()}; }
  // log p of the pole of each column.
  [[nodiscard]] std::pair<const double*, const double*> exponents() const REALTIME {
    return {row(exponent_re), row(exponent_im)};
  }
  // Properties of the whole object in its size, which no mode has for itself.
  struct Whole {
    Vec3 origin_m;             // the place that its sound comes from, in its frame
    double ring_s = 0;         // in which its longest mode falls by 20 dB
    double mouth_area_m2 = 0;  // 0: it has no air with modes of its own
  };
  [[nodiscard]] const Whole& whole() const REALTIME { return whole_; }

  // The arrays that a kernel needs to render chunks of `frames`, with states of columns() numbers each.
  [[nodiscard]] ModeArrays modes(double* z_re, double* z_im, std::size_t frames) const REALTIME;
  [[nodiscard]] MomentArrays moments() const REALTIME {
    return {band_.data(), moment_weights_.get(), line_weights_.get()};
  }

  // The click of the object as a whole; nothing if the bank does not state its mass, or if it is too large to click.
  std::optional<ClickShape> click;
  // The detuning of its modes by each other, and the modes that may exchange energy; null if the bank has no such data.
  std::shared_ptr<const GlideMatrix> glide;
  std::shared_ptr<const CoupledTable> coupled;

  class InstanceGroup* instances = nullptr;  // of the objects that share this table (instance_group.h) [audio]

 private:
  enum Row { pole_re, pole_im, full_re, full_im, rest_re, rest_im, exponent_re, exponent_im, kRows };

  void add_mode(std::uint32_t mode, const modal::DampedMode& damped, std::complex<double> s);
  [[nodiscard]] double* row(Row which) const REALTIME { return rows_.get() + which * columns_; }

  std::shared_ptr<const modal::StrikeMap> map_;
  modal::MaterialScale material_;
  modal::Dampers dampers_;
  modal::ModeRange modes_;
  double sample_rate_hz_;
  TableSettings settings_;
  double per_size_;                      // from points of the object to those of its bank
  std::vector<std::uint32_t> mode_of_;   // of playable mode i
  std::vector<std::int32_t> column_of_;  // of a mode of the bank; -1 where it is not playable
  std::vector<double> weight_;  // output per modal velocity: pressure over full scale, gain, the scale of shapes
  std::size_t columns_ = 0, slow_modes_ = 0, slow_groups_ = 0;
  std::size_t rest_frames_ = 0;         // whose advance stands in rest_re and rest_im
  AlignedArray<double> rows_;           // kRows x columns
  AlignedArray<float> strides_;         // 2 x columns: p^kRun
  AlignedArray<float> runs_;            // columns x 2 kRun
  AlignedArray<float> moment_weights_;  // columns x 2 kMoments
  AlignedArray<float> line_weights_;    // columns x 2 kGridReach; null without ambisonic channels
  std::vector<std::uint16_t> band_;
  std::vector<double> slowest_decay_;  // of each group
  std::vector<std::uint32_t> rank_;    // of each column
  AlignedArray<float> column_hz_, tube_shares_;
  Whole whole_;
};

}  // namespace ringdown::synth
