// The far fields of a bank's modes, packed for computing the gains of all modes in one direction at once.
//
// A mode's gain is the far field F(d) over the rms of F over all directions; it is complex. Its phase is conjugate to
// F's, because the mixer's modes go as exp(+i omega t), and rotated so that the gains of a mode that is small beside
// the wavelength are real: the lobes of such a mode are in phase or opposite, and a blow that begins as a sine is then
// heard as a sine.
//
// Modes are ordered by ascending frequency (StrikeMap::rank()), in groups of kGroup. Each group has one list of the
// spherical harmonics that any of its modes needs. [any thread]
#pragma once

#include "engine/modal/radiation_map.h"

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::modal {

class DirectionMap {
 public:
  static constexpr std::size_t kGroup = 8;

  DirectionMap() = default;  // a map without modes
  // `by_frequency`: the numbers of the modes, by ascending frequency. [worker]
  DirectionMap(const RadiationMaps& maps, std::span<const std::uint32_t> by_frequency);

  [[nodiscard]] bool empty() const REALTIME { return first_.empty(); }
  [[nodiscard]] std::size_t groups() const REALTIME { return first_.empty() ? 0 : first_.size() - 1; }
  [[nodiscard]] int degree() const REALTIME { return degree_; }  // the highest degree, for real_harmonics()
  // The fastest change of any mode's gain with direction, in multiples of its rms per radian: the root of the mean
  // l (l + 1) of its harmonics.
  [[nodiscard]] double sharpness() const REALTIME { return sharpness_; }

  [[nodiscard]] std::size_t terms() const REALTIME { return harmonics_.size(); }
  // Group g has the terms first()[g] ... first()[g + 1] - 1. Term t has a harmonic, and from position 2 kGroup t on
  // 2 kGroup numbers: the real parts of the group's modes, then their imaginary parts.
  [[nodiscard]] const std::uint32_t* first() const REALTIME { return first_.data(); }
  [[nodiscard]] const std::uint16_t* harmonics() const REALTIME { return harmonics_.data(); }
  [[nodiscard]] const float* values() const REALTIME { return values_.data(); }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint16_t> harmonics_;
  std::vector<float> values_;
  int degree_ = -1;
  double sharpness_ = 0;
};

}  // namespace ringdown::modal
