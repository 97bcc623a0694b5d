// Which groups of modes need not be computed because louder ones hide them.
//
// The mixer surveys, now and then, what sounds: note() for each mode. decide() then says how loud a mode in each half
// Bark must be (Cut); a group goes when all its modes may. Masking is engine/modal/masking.h's, over all objects
// together: what is left out of half a Bark lies, all of it added up, below what the loudest modes hide there. Full
// scale is taken as kFullScale_db_spl; played louder, sounds hide more.
//
// When time is short (budget.h) everything below one level goes too, whatever its pitch.
#pragma once

#include "engine/base/realtime.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

inline constexpr double kFullScale_db_spl = 80;  // quiet listening

// An energy (|z|^2, full scale 1) on a scale whose steps are 1.5 dB, to a quarter of a dB.
using Level = std::int32_t;
inline constexpr double kStep_db = 1.5051499783199060;
constexpr Level level_of(double energy) {
  return static_cast<Level>(std::bit_cast<std::uint32_t>(static_cast<float>(energy)) >> 22) - 254;
}

// Half a Bark each.
using EarBand = std::uint8_t;
inline constexpr std::size_t kEarBands = 50;
EarBand ear_band_of(double frequency_hz);  // [any]

// The least level at which a mode of each band counts.
struct Cut {
  static constexpr Level kNothing = -1000;
  std::array<Level, kEarBands> at;
  bool hides = false;        // some do not pass
  std::uint32_t number = 0;  // another one when all must hear of it at once

  Cut() { at.fill(kNothing); }
  [[nodiscard]] bool passes(EarBand band, Level level) const RINGDOWN_REALTIME { return level >= at[band]; }
};

class Hearing {
 public:
  Hearing();  // [worker]

  // From here on: one audio thread.
  void forget() RINGDOWN_REALTIME;
  void note(EarBand band, Level level, std::uint32_t modes = 1) RINGDOWN_REALTIME;
  // And once for each group, which comes and goes as a whole: its loudest mode.
  void note_group(EarBand band, Level level, std::uint32_t modes) RINGDOWN_REALTIME;

  // Without `masking` everything from `least` on passes.
  [[nodiscard]] Cut decide(bool masking, Level least = Cut::kNothing) const RINGDOWN_REALTIME;

  // The level below which groups go so that at most so many modes are left after masking; kLowest when masking is
  // enough, kNothing when all fit as they are.
  [[nodiscard]] Level least_for(double modes) const RINGDOWN_REALTIME;

  static constexpr Level kLowest = -110, kLevels = 140;  // -165 ... +45 dB

 private:
  using Thresholds = std::array<Level, kEarBands>;

  [[nodiscard]] Thresholds hidden_below() const RINGDOWN_REALTIME;

  std::array<std::array<std::uint32_t, kLevels>, kEarBands> count_;
  std::array<std::array<std::uint32_t, kLevels>, kEarBands> in_groups_;  // modes, by the loudest of their group
  std::uint64_t modes_ = 0;                                              // in groups
  std::array<double, kLevels> energy_;                                   // of a level, at most
  std::array<double, kEarBands> centre_hz_, centre_bark_;
};

}  // namespace ringdown::synth
