// The modes of a bank under a force at one place, by the leapfrog rule in steps of a 64th of a sample: an oracle for
// two-way contacts that shares nothing with the engine but the bank's shapes.
#pragma once

#include "tests/synth/player.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace ringdown::synth::test {

class LeapfrogBank {
 public:
  static constexpr int kSteps = 64;  // of a sample
  static constexpr double kStep_s = 1 / (kRate * kSteps);

  // Displacements and forces are along the unit `direction`.
  LeapfrogBank(const modal::StrikeMap& map, Vec3 point_m, Vec3 direction)
      : bank_(map.bank()), shape_(bank_.mode_count()), q_(shape_.size()), v_(shape_.size()) {
    map.excite(point_m, direction, shape_);
  }

  [[nodiscard]] double displacement_m() const { return sum_of(q_); }
  [[nodiscard]] double speed_m_s() const { return sum_of(v_); }
  [[nodiscard]] double per_kg() const { return sum_of(shape_); }  // what a short push sets in motion

  void step(double force_n) {
    for (std::size_t m = 0; m < q_.size(); ++m) {
      const double omega = omega_of(m), d = bank_.decay_per_s[m];
      v_[m] += kStep_s * (shape_[m] * force_n - (omega * omega + d * d) * q_[m] - 2 * d * v_[m]);
      q_[m] += kStep_s * v_[m];
    }
  }

  // A sample of one channel; what the force only bends does not sound.
  [[nodiscard]] double sample(double force_n) const {
    double sound = 0;
    for (std::size_t m = 0; m < q_.size(); ++m) {
      const double omega = omega_of(m), d = bank_.decay_per_s[m];
      sound += omega * omega * (q_[m] - shape_[m] * force_n / (omega * omega + d * d));
    }
    return std::numbers::sqrt2 / 2 * kLoudness * sound;
  }

 private:
  [[nodiscard]] double omega_of(std::size_t mode) const { return 2 * std::numbers::pi * bank_.frequency_hz[mode]; }
  [[nodiscard]] double sum_of(const std::vector<double>& modal) const {
    double sum = 0;
    for (std::size_t m = 0; m < shape_.size(); ++m) sum += shape_[m] * modal[m];
    return sum;
  }

  const modal::Bank& bank_;
  std::vector<double> shape_, q_, v_;
};

}  // namespace ringdown::synth::test
