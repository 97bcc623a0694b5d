// Size and thinness of a body, the mesh size that it needs, and a check for the wrong unit of length. [any thread]
//
// The highest note of the band sets the shortest wave that the mesh must follow: a shear wave, c_t / f, or where the
// body is thin, a bending wave of a plate of its thickness, 2 pi (D / (rho h))^(1/4) / sqrt(omega) with
// D = E h^3 / (12 (1 - nu^2)) (Landau & Lifshitz, Theory of Elasticity, sections 22 and 25). Elements per wave, by
// order: 20, 8, 4, 2.5. Beside waves, elements must follow what happens within a thickness of sharp edges, where twist
// lets go, and how a slender body's section warps; and flat ones, longer than p + 1 thicknesses, bend too stiffly.
// Where the thinnest wall is known and less than 2 V / A, it is the thickness. With order 3 that leaves less than 0.1 %
// in the first fifty frequencies and 0.02 % in the first ten of the bodies in docs/how/accuracy.md; linear elements do
// not reach that at any sane size.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"
#include "engine/modal/bank.h"

#include <filesystem>
#include <string>

namespace ringdown::bake {

struct BodyShape {
  double volume_m3 = 0;
  double thickness_m = 0;  // 2 V / A: a plate's and a shell's own thickness, less than a compact body's
  double wall_m = 0;       // the thinnest wall (mesh/surface_distance.h); 0: not known
  double width_m = 0;      // the second of its three principal extents, as if it were a box of its inertia
  double length_m = 0;     // the diagonal of its box
  double bend_per_m = 0;   // mean of |k1 + k2| over its surface, sharp edges left out: 1 / R of a tube
};

// Measures the body by any mesh of it; the coarsest will do.
BodyShape measure_shape(const mesh::TetMesh& mesh);

// Measures the body by its skin, which should be closed.
BodyShape measure_shape(const mesh::TriangleMesh& skin, double wall_m);

struct MeshChoice {
  double size_m = 0, edge_size_m = 0;  // as in mesh::GmshOptions
  double shortest_wave_m = 0;
  double wall_m = 0;     // the thinnest wall, which counted as the thickness; 0: not known
  bool bounded = false;  // made coarser than the wave asks, to keep within max_unknowns
};

// Guessed from the volume; true within a factor of two for gmsh's meshes.
double estimated_unknowns(const BodyShape& shape, double size_m, int order);

MeshChoice choose_mesh(const BodyShape& shape, const modal::Material& material, double band_high_hz, int order,
                       double max_unknowns);

// Chooses the size that gives about `unknowns` unknowns, however short the waves are.
MeshChoice choose_coarse_mesh(const BodyShape& shape, int order, double unknowns);

// The lowest note that a free body of that size may have [Hz], to a factor of two or three: the lower of a bar's
// bending, 1.03 h / L^2 sqrt(E / rho), and half a shear wave along its length.
double guessed_lowest_hz(const BodyShape& shape, const modal::Material& material);

// About how many modes a solid has below an eigenvalue: Debye's count V omega^3/(6 pi^2) (1/c_l^3 + 2/c_t^3) of waves
// with the two speeds of sound (Landau & Lifshitz, Statistical Physics, section 64; Theory of Elasticity, section 22).
// Plates and shells have more.
double debye_count(double volume_m3, const modal::Material& material, double lambda);

// Doubts the size of a body whose bank should go up to `band_high_hz` and hold at most `max_modes`. Returns an empty
// string if the size is plausible. Otherwise returns a sentence with the body's length, the consequence for its sound,
// and the unit that would be plausible: "cup.stl is 95 m long, ...; if its unit is the millimetre (--unit mm), it is
// 95 mm long and its lowest note about 1200 Hz".
std::string question_size(const BodyShape& shape, const modal::Material& material, double band_high_hz, int max_modes,
                          const std::filesystem::path& path, double unit_m);

// Fails when the body lies too far from the origin. A bank keeps positions as 32-bit floats, which have 24 bits: at ten
// thousand times its length from the origin a body still has points to a thousandth of its length.
Result<void> check_place(const mesh::Points& nodes, double length_m);

// Fails when far more than `max_modes` modes lie below the eigenvalue, which is that of `band_high_hz`.
Result<void> check_count(double volume_m3, const modal::Material& material, double lambda, double band_high_hz,
                         int max_modes);

}  // namespace ringdown::bake
