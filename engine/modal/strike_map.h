// Finds how much a strike, an impulse at a point, excites every mode.
//
// A StrikeMap holds the surface index of a bank and its shapes, point by point, so that the modes of one point lie side
// by side. The worker builds one per bank, and the bank's voices share it.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/direction_map.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/surface_index.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace ringdown::modal {

class StrikeMap {
 public:
  // The bank must have passed read_bank's checks. [worker]
  explicit StrikeMap(std::shared_ptr<const Bank> bank);

  [[nodiscard]] const Bank& bank() const REALTIME { return *bank_; }

  // The index of the surface, which finds where a strike lands.
  [[nodiscard]] const SurfaceIndex& surface() const REALTIME { return surface_; }

  // by_frequency(): the bank's modes by ascending frequency; modes of equal frequency are in the bank's order. rank():
  // the place of a mode in that list.
  [[nodiscard]] const std::vector<std::uint32_t>& by_frequency() const REALTIME { return by_frequency_; }
  [[nodiscard]] std::uint32_t rank(std::size_t mode) const REALTIME { return rank_[mode]; }

  // The loudness of the bank's modes.
  [[nodiscard]] const Loudness& loudness() const { return loudness_; }

  // The directional gains of the modes; empty when the bank has no radiation maps.
  [[nodiscard]] const DirectionMap& directions() const REALTIME { return directions_; }

  // amplitudes[m] = phi_m(p) . j [J^1/2]: the modal velocity that the impulse gives mode m. `amplitudes` has one
  // element per mode of the bank. Cost O(modes), plus finding the surface point. [audio]
  void excite(Vec3 point_m, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME;

  // Excites at a sample point, `vertex` < bank().point_count(). [audio]
  void excite_vertex(std::size_t vertex, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME;

 private:
  void add(std::size_t point, Vec3 impulse_ns, std::span<double> amplitudes) const REALTIME;

  std::shared_ptr<const Bank> bank_;
  SurfaceIndex surface_;
  Loudness loudness_;
  DirectionMap directions_;
  std::vector<std::uint32_t> by_frequency_, rank_;
  std::vector<float> shapes_;  // P x 3 x M: x of all modes at a point, then y, then z
};

}  // namespace ringdown::modal
