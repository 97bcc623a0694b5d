// Whether a body can be as large as its file says. [any thread]
#pragma once

#include "engine/bake/bake.h"
#include "engine/bake/mesh_choice.h"

#include <filesystem>
#include <string>

namespace ringdown::bake {

// The lowest note that a free body of that size may have [Hz], to a factor of two or three: the lower of a bar's
// bending, 1.03 h / L^2 sqrt(E / rho), and half a shear wave along its length.
double guessed_lowest_hz(const BodyShape& shape, const modal::Material& material);

// About how many modes a solid has below an eigenvalue: Debye's count V omega^3/(6 pi^2) (1/c_l^3 + 2/c_t^3) of waves
// with the two speeds of sound (Landau & Lifshitz, Statistical Physics, section 64; Theory of Elasticity, section 22).
// Plates and shells have more.
double debye_count(double volume_m3, const modal::Material& material, double lambda);

// Nothing where the size may be meant. Else one sentence that says how large the body is, what would be wrong with its
// sound, and with which unit it would be right: "cup.stl is 95 m long, ...; if its unit is the millimetre (--unit mm),
// it is 95 mm long and its lowest note about 1200 Hz".
std::string question_size(const BodyShape& shape, const modal::Material& material, const BakeOptions& options,
                          const std::filesystem::path& path, double unit_m);

}  // namespace ringdown::bake
