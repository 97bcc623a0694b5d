// The force between two surfaces pressed together by a depth d: Hunt and Crossley's law,
//
//   f = k d^alpha (1 + mu d'),   never negative, 0 while d <= 0                     [J. Appl. Mech. 42, 440 (1975)]
//
// over one time step, as a straight line in the change of the depth during that step. The line is passive: what the
// bodies lose, f times the change, is what the spring stores, psi^2 / 2, and a loss that is never negative. So no
// stiffness, step or prediction can make energy. [any thread]
#pragma once

#include "engine/base/realtime.h"

namespace ringdown::contact {

struct ImpactLaw {
  double stiffness = 1e8;  // k [N / m^exponent]
  double exponent = 1.5;   // alpha >= 1: 1.5 between round bodies (Hertz), 1 for a spring, 2 to 3 for felt
  double damping_s_m = 0;  // mu: restitution is about 1 - (2/3) mu v at small speeds v
  // Below 1: mu is chosen as each contact begins, so that its bounce at the speed of that moment is this, and what
  // bounces comes to rest [Hu & Guo, Powder Technol. 286, 187 (2015): mu = 1.5 (1 - e) / (e v)].
  double bounce = 1;
};

// f = at_rest + per_m * (change of depth).
struct Line {
  double at_rest = 0, per_m = 0;
};

class Impact {
 public:
  // The step to come has the force on a line, and a force that was predicted.
  struct Step {
    Line line;
    double force_n = 0;
    bool touches = false;
  };

  // Foresees a step of `step_s` in which the depth would change by `free_m` without force; a force lowers the change by
  // `compliance_m_n` per newton.
  [[nodiscard]] Step foresee(const ImpactLaw& law, double free_m, double compliance_m_n,
                             double step_s) RINGDOWN_REALTIME;
  // Ends the foreseen step: the depth has changed, under the line's force, or, with `released`, under none because the
  // line's was negative.
  void advance(const ImpactLaw& law, double change_m, bool released) RINGDOWN_REALTIME;

  [[nodiscard]] double depth_m() const RINGDOWN_REALTIME { return depth_m_; }
  // Nothing touches yet; what is pressed together at once is so without speed.
  void place(double depth_m) RINGDOWN_REALTIME { depth_m_ = depth_m, psi_ = damping_s_m_ = 0; }
  // Moves the zero of depths without doing work, as when the stiffness or the place of the contact changes.
  void shift(const ImpactLaw& law, double by_m) RINGDOWN_REALTIME;
  [[nodiscard]] double energy_j() const RINGDOWN_REALTIME { return 0.5 * psi_ * psi_; }

 private:
  [[nodiscard]] Step foresee_small(double straight_n_m, double share, double free_m, double compliance_m_n,
                                   double loss) RINGDOWN_REALTIME;
  [[nodiscard]] Step closed(double free_m, double compliance_m_n, double loss) const RINGDOWN_REALTIME;

  double depth_m_ = -1;     // negative: so far apart
  double psi_ = 0;          // sqrt(2 energy)
  double damping_s_m_ = 0;  // of the contact that goes on
  double secant_ = 0;       // of the foreseen step: change of psi per change of depth
  bool touches_ = false;
};

}  // namespace ringdown::contact
