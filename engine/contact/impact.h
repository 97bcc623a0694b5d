// The force between two surfaces pressed together by a depth d: Hunt and Crossley's law,
//
//   f = k d^alpha (1 + mu d'),   never negative, 0 while d <= 0                     [J. Appl. Mech. 42, 440 (1975)]
//
// over one time step, linear in the change of depth during that step. The line is passive: the energy that the bodies
// lose, f times the change, equals the change of the spring's energy, psi^2 / 2, plus a loss that is never negative. So
// no stiffness, step or prediction can create energy. [any thread]
#pragma once

#include "engine/base/realtime.h"

namespace ringdown::contact {

struct ImpactLaw {
  double stiffness = 1e8;  // k [N / m^exponent]
  double exponent = 1.5;   // alpha >= 1: 1.5 between round bodies (Hertz), 1 for a spring, 2 to 3 for felt
  double damping_s_m = 0;  // mu: restitution is about 1 - (2/3) mu v at small speeds v
  // Restitution. If below 1, mu is chosen when a contact begins, so that the bounce at that moment's speed has this
  // restitution and bouncing bodies come to rest [Hu & Guo, Powder Technol. 286, 187 (2015): mu = 1.5 (1 - e) / (e v)].
  double bounce = 1;
};

// f = at_rest + per_m * (change of depth).
struct Line {
  double at_rest = 0, per_m = 0;
};

class Impact {
 public:
  // A predicted step: its force as a line, and the predicted force.
  struct Step {
    Line line;
    double force_n = 0;
    bool touches = false;
  };

  // Predicts a step of `step_s` in which the depth would change by `free_m` without force. A force lowers the change by
  // `compliance_m_n` per newton.
  [[nodiscard]] Step foresee(const ImpactLaw& law, double free_m, double compliance_m_n, double step_s) REALTIME;
  // Ends the predicted step, in which the depth has changed by `change_m`, under the line's force, or, with `released`,
  // without force because the line's was negative.
  void advance(const ImpactLaw& law, double change_m, bool released) REALTIME;

  [[nodiscard]] double depth_m() const REALTIME { return depth_m_; }
  // Starts without a contact. If `depth_m` > 0 the surfaces are pressed together, without speed.
  void place(double depth_m) REALTIME {
    depth_m_ = depth_m;
    psi_ = damping_s_m_ = 0;
  }
  // Shifts the zero of depths without doing work, for a change of the contact's stiffness or place.
  void shift(const ImpactLaw& law, double by_m) REALTIME;
  [[nodiscard]] double energy_j() const REALTIME { return 0.5 * psi_ * psi_; }

 private:
  [[nodiscard]] Step foresee_small(double straight_n_m, double share, double free_m, double compliance_m_n,
                                   double loss) REALTIME;
  [[nodiscard]] Step closed(double free_m, double compliance_m_n, double loss) const REALTIME;

  double depth_m_ = -1;     // negative: distance between the surfaces
  double psi_ = 0;          // sqrt(2 energy)
  double damping_s_m_ = 0;  // damping of the present contact
  double secant_ = 0;       // change of psi per change of depth in the predicted step
  bool touches_ = false;
};

}  // namespace ringdown::contact
