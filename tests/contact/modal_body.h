// A body for tests: modes moved on one step at a time by the closed form for a force that is constant in the step, in
// long double, so that what energy a million steps gain or lose is the contact's.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

namespace ringdown::contact {

class ModalBody {
 public:
  explicit ModalBody(double step_s) : step_s_(step_s) {}

  // A mode of unit modal mass that a force at place p moves by shapes[p]; omega 0 is a rigid motion.
  void add(double omega_rad_s, double decay_per_s, std::vector<double> shapes) {
    Mode mode{.omega = omega_rad_s, .shapes = std::move(shapes)};
    const long double h = step_s_, s = decay_per_s, w = omega_rad_s;
    if (w == 0) {
      mode.a11 = 1, mode.a12 = h, mode.a21 = 0, mode.a22 = 1, mode.bq = h * h / 2, mode.bv = h;
    } else {
      const long double wd = std::sqrt(w * w - s * s), e = std::exp(-s * h), c = std::cos(wd * h),
                        sn = std::sin(wd * h);
      mode.a11 = e * (c + s / wd * sn), mode.a12 = e * sn / wd;
      mode.a21 = -e * w * w / wd * sn, mode.a22 = e * (c - s / wd * sn);
      mode.bq = (1 - mode.a11) / (w * w), mode.bv = mode.a12;
    }
    modes_.push_back(std::move(mode));
  }
  void add_mass(double kg, std::size_t places = 1) { add(0, 0, std::vector<double>(places, 1 / std::sqrt(kg))); }

  [[nodiscard]] double compliance(std::size_t p, std::size_t q) const {
    long double sum = 0;
    for (const Mode& m : modes_) sum += m.shapes[p] * m.bq * m.shapes[q];
    return static_cast<double>(sum);
  }
  [[nodiscard]] double displacement(std::size_t p) const {
    long double sum = 0;
    for (const Mode& m : modes_) sum += m.shapes[p] * m.q;
    return static_cast<double>(sum);
  }
  [[nodiscard]] double velocity(std::size_t p) const {
    long double sum = 0;
    for (const Mode& m : modes_) sum += m.shapes[p] * m.v;
    return static_cast<double>(sum);
  }
  // By what the displacement changes in the next step without force.
  [[nodiscard]] double free_change(std::size_t p) const {
    long double sum = 0;
    for (const Mode& m : modes_) sum += m.shapes[p] * (m.omega == 0 ? m.a12 * m.v : (m.a11 - 1) * m.q + m.a12 * m.v);
    return static_cast<double>(sum);
  }
  [[nodiscard]] double energy() const {
    long double sum = 0;
    for (const Mode& m : modes_) sum += 0.5L * (m.v * m.v + m.omega * m.omega * m.q * m.q);
    return static_cast<double>(sum);
  }
  void step(const std::vector<double>& force_n) {
    for (Mode& m : modes_) {
      long double f = 0;
      for (std::size_t p = 0; p < force_n.size(); ++p) f += m.shapes[p] * force_n[p];
      const long double q = m.a11 * m.q + m.a12 * m.v + m.bq * f;
      m.v = m.a21 * m.q + m.a22 * m.v + m.bv * f;
      m.q = q;
    }
  }
  void kick(std::size_t mode, double velocity) { modes_[mode].v += velocity; }
  [[nodiscard]] std::size_t size() const { return modes_.size(); }

 private:
  struct Mode {
    long double omega = 0, a11 = 0, a12 = 0, a21 = 0, a22 = 0, bq = 0, bv = 0, q = 0, v = 0;
    std::vector<double> shapes;
  };
  double step_s_;
  std::vector<Mode> modes_;
};

}  // namespace ringdown::contact
