// Computes the sound of a bar of a material without finite elements: the preview of `ringdown materials`. [any thread]
//
// A free rectangular bar bent across its thickness, as Timoshenko's beam: shear and rotary inertia are in it, with
// Cowper's shear coefficient 10 (1 + nu) / (12 + 11 nu). [Timoshenko, Phil. Mag. 41, 1921; Cowper, J. Appl. Mech. 33,
// 1966.] The frequencies are the exact roots of that model; it knows no twist and no bending across the width, which a
// blow on the middle line of a real bar hardly rings. Within 1 % of a solid's frequencies while half a wave is longer
// than the width (tests/bake/material_bar_test.cpp).
#pragma once

#include "engine/modal/bank.h"

#include <vector>

namespace ringdown::bake {

struct Bar {
  double length_m = 0.2, width_m = 0.03, thickness_m = 0.008;
};

// Eigenvalues lambda [rad^2/s^2] of the bending modes up to `highest_lambda`, ascending; none beyond 0.8 of the
// frequency at which shear waves stand across the thickness.
std::vector<double> bar_lambdas(const modal::Material& material, const Bar& bar, double highest_lambda);

// The bar's bending modes below 20 kHz as a bank, from the lowest on: kBarPoints sample points along the middle of
// its upper face, end to end, and shapes with the sideways motion that turning sections have there. Over-damped modes
// are left out; there may be none.
inline constexpr int kBarPoints = 41;
modal::Bank bar_bank(const modal::Material& material, const Bar& bar = {});

}  // namespace ringdown::bake
