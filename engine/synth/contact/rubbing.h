// The force of two surfaces that slide or roll on each other: a random profile, felt at the speed at which it passes.
//
// A surface's heights are random: their power falls with spatial frequency f as f^slope from the correlation length
// down to a sixteenth of it, as KHR_audio_rigid_bodies describes acoustic surfaces. What slides climbs and descends
// that profile, and the force on it varies by the contact's force times the profile's slope under it; so the pitch of
// the sound follows the speed, and its level the load. What rolls touches a larger patch and feels only the waves
// kRollingRatio times as long. A contact that stands still makes no force.
//
// If a surface's own heights are known (engine/modal/surface_relief.h), they are felt instead, each surface's at the
// speed at which the contact travels over it, and smoothed over the width of the region that bears. Its mesoscale
// relief is felt besides.
//
// The random profile is a sum of octaves of cubic B-splines over random numbers, which a hash finds anew wherever they
// are needed, so nothing is stored and the same contact sounds the same each time. Octaves beyond hearing are left out.
#pragma once

#include "engine/base/realtime.h"
#include "engine/modal/surface_relief.h"
#include "engine/synth/events/event.h"
#include "engine/synth/events/ramp.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

inline constexpr double kContactTimeOut_s = 0.1;  // a contact that is not updated for so long ends
inline constexpr double kRollingRatio = 40;  // as the draft's defaults of waviness and roughness stand to each other

class Rubbing {
 public:
  Rubbing() = default;
  // At rest, without force. Contacts with the same seed have the same profile. [audio]
  Rubbing(std::uint32_t seed, double sample_rate_hz) REALTIME;

  // Sets the contact from frame `at` on. Force and speeds get there in a straight line, as long as the time since the
  // last update but at least 2 ms and at most 50 ms; the first time, and when the contact ends, in 5 ms. [audio]
  void update(Frame at, const Contact& contact) REALTIME;

  // The impulse [N s] in frames first ... first + count - 1, along the contact's force. Frames are asked for once, in
  // order. [audio]
  void fill(Frame first, std::size_t count, double* impulses) REALTIME;

  // The slope of the profiles under the contact in these frames, without its running mean. [audio]
  void fill_slopes(Frame first, std::size_t count, double* slopes) REALTIME;

  // The first frame without force, once the contact has ended; kNever before. [audio]
  [[nodiscard]] Frame over_from() const REALTIME { return force_n_.to == 0 ? force_n_.end : kNever; }

  // Frames are of another length from `now` on. [worker]
  void rescale(Frame now, double ratio);

 private:
  static constexpr std::size_t kOctaves = Texture::kOctaves, kMaxOctaves = Texture::kMaxOctaves;
  struct Heights {
    std::array<double, kMaxOctaves> of_octave_m{};
    std::size_t count = 0;
  };
  // The random numbers around a place, and a cubic B-spline over them.
  struct Spline {
    std::uint64_t seed = 0;
    std::int64_t place = -1;
    std::array<double, 4> around{};  // of places place - 1 ... place + 2; none known yet where `fresh`
    bool fresh = true;
    [[nodiscard]] double slope_at(double u) REALTIME;
  };
  struct Track {
    double at_m = 0;
    double longest_m = 1;
    std::array<Spline, kMaxOctaves> octaves;
    // The profile's slope under the contact, which moves on at `speed_m_s` for a frame.
    [[nodiscard]] double pass(const Heights& heights_m, double speed_m_s, double sample_rate_hz) REALTIME;
  };

  // A surface whose heights are known.
  struct Known {
    const modal::SurfaceRelief* relief = nullptr;
    Ramp speed_m_s;
    double at_m = 0;
    modal::SurfaceTrack::Blend profile, mesoscale;
  };
  void know(const Contact& contact, Frame at, Frame ramp) REALTIME;
  [[nodiscard]] double pass_known(Frame frame) REALTIME;

  double rate_hz_ = 1;
  Ramp force_n_, slip_m_s_, roll_m_s_;
  Texture texture_;
  Heights heights_m_;  // of each octave
  Track sliding_, rolling_;
  std::array<Known, 2> known_;
  bool has_profile_ = false, has_relief_ = false;  // of either surface
  bool begun_ = false;
  double mean_slope_ = 0;  // running mean: only deviations from it are felt
  Frame updated_ = 0, time_out_ = 0;
};

}  // namespace ringdown::synth
