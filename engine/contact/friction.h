// The force between two surfaces that slide, creep or stick: bristles of stiffness sigma0 that bend by z and slip when
// they are bent too far,
//
//   f = sigma0 z + sigma1 z' + sigma2 v,   z' = v (1 - alpha(z, v) z / z_ss(v)),   z_ss = g(|v|) / sigma0,
//
// with the Stribeck curve g = N (mu_d + (mu_s - mu_d) / (1 + (v / v_s)^2)) and Dupont's alpha, which is 0 while the
// bristles stick, so that what rests does not creep [Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Autom. Control
// 47, 787 (2002)]. In one or two directions of the surface. Over one time step the force is a straight line in the
// displacement of that step, and takes more from the bodies than the bristles store. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/contact/impact.h"

#include <array>

namespace ringdown::contact {

struct FrictionLaw {
  double static_coefficient = 0.4;   // mu_s
  double sliding_coefficient = 0.2;  // mu_d <= mu_s, at high speed
  double stribeck_m_s = 0.05;        // v_s: where half the difference is lost
  double bristle_n_m = 1e5;          // sigma0
  double bristle_ns_m = 0;           // sigma1: damping of bristles, at speeds below v_s
  double viscous_ns_m = 0;           // sigma2
  double stick_share = 0.7;          // of the sliding coefficient's bend, up to which bristles stick
};

// A displacement, speed or force along the surface; the second is 0 where one direction is enough.
using Along = std::array<double, 2>;
// By what a force along the surface lowers the displacement: xx, xy, yy [m / N].
struct AlongCompliance {
  double xx = 0, xy = 0, yy = 0;
};

class Friction {
 public:
  struct Step {
    Along at_rest{};   // f = at_rest + per_m * displacement
    double per_m = 0;  // in either direction
    Along force_n{};   // as predicted
  };

  // Foresees a step in which the surfaces would slide by `free_m` without friction, pressed together by `normal_n` >=
  // 0.
  [[nodiscard]] Step foresee(const FrictionLaw& law, double normal_n, const Along& free_m,
                             const AlongCompliance& compliance_m_n, double step_s) RINGDOWN_REALTIME;
  // Ends the foreseen step: the surfaces have slid by `by_m`.
  void advance(const Along& by_m, double step_s) RINGDOWN_REALTIME;
  // Bristles become `by` times as stiff: the force stays, or falls where it would take energy to keep it.
  void stiffen(double by) RINGDOWN_REALTIME;
  void release() RINGDOWN_REALTIME { bend_ = {}, slip_m_s_ = 0, rate_ = 0, rubs_ = false; }

  [[nodiscard]] double energy_j(const FrictionLaw& law) const RINGDOWN_REALTIME {
    return 0.5 * law.bristle_n_m * (bend_[0] * bend_[0] + bend_[1] * bend_[1]);
  }
  [[nodiscard]] double slip_m_s() const RINGDOWN_REALTIME { return slip_m_s_; }

 private:
  Along bend_{};         // z [m]
  double slip_m_s_ = 0;  // speed in the last step
  double rate_ = 0;      // alpha |v| / z_ss of the foreseen step [1/s]
  bool rubs_ = false;    // in the foreseen step
};

}  // namespace ringdown::contact
