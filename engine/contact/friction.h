// The force between two surfaces that slide, creep or stick: bristles of stiffness sigma0 that bend by z and slip when
// they are bent too far,
//
//   f = sigma0 z + sigma1 z' + sigma2 v,   z' = v (1 - alpha(z, v) z / z_ss(v)),   z_ss = g(|v|) / sigma0,
//
// with the Stribeck curve g = N (mu_d + (mu_s - mu_d) / (1 + (v / v_s)^2)) and Dupont's alpha, which is 0 while the
// bristles stick, so that bodies at rest do not creep [Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Autom.
// Control 47, 787 (2002)]. The force has one or two directions along the surface. Over one time step it is linear in
// the displacement of that step, and takes more energy from the bodies than the bristles store. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/contact/impact.h"

#include <array>

namespace ringdown::contact {

struct FrictionLaw {
  double static_coefficient = 0.4;   // mu_s
  double sliding_coefficient = 0.2;  // mu_d <= mu_s, at high speed
  double stribeck_m_s = 0.05;        // v_s: speed at which half of mu_s - mu_d is lost
  double bristle_n_m = 1e5;          // sigma0
  double bristle_ns_m = 0;           // sigma1: damping of bristles, at speeds below v_s
  double viscous_ns_m = 0;           // sigma2
  double stick_share = 0.7;          // bristles stick up to this share of their bend in steady sliding
};

// A displacement, speed or force along the surface. The second component is 0 if one direction is enough.
using Along = std::array<double, 2>;
// Displacement by which a unit force along the surface lowers the sliding: xx, xy, yy [m / N].
struct AlongCompliance {
  double xx = 0, xy = 0, yy = 0;
};

class Friction {
 public:
  struct Step {
    Along at_rest{};   // f = at_rest + per_m * displacement
    double per_m = 0;  // equal in both directions
    Along force_n{};   // predicted force
  };

  // Predicts the force in a step in which the surfaces would slide by `free_m` without friction. `normal_n` >= 0
  // presses them together.
  [[nodiscard]] Step foresee(const FrictionLaw& law, double normal_n, const Along& free_m,
                             const AlongCompliance& compliance_m_n, double step_s) REALTIME;
  // Ends the predicted step, in which the surfaces have slid by `by_m`.
  void advance(const Along& by_m, double step_s) REALTIME;
  // Makes the bristles `by` times as stiff. The force is kept, or lowered if keeping it would add energy.
  void stiffen(double by) REALTIME;
  void release() REALTIME { bend_ = {}, slip_m_s_ = 0, rate_ = 0, rubs_ = false; }

  [[nodiscard]] double energy_j(const FrictionLaw& law) const REALTIME {
    return 0.5 * law.bristle_n_m * (bend_[0] * bend_[0] + bend_[1] * bend_[1]);
  }
  [[nodiscard]] double slip_m_s() const REALTIME { return slip_m_s_; }

 private:
  Along bend_{};         // z [m]
  double slip_m_s_ = 0;  // speed in the last step
  double rate_ = 0;      // alpha |v| / z_ss of the predicted step [1/s]
  bool rubs_ = false;    // whether the surfaces rub in the predicted step
};

}  // namespace ringdown::contact
