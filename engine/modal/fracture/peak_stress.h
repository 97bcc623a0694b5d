// The largest tensile stress on the skin of a body that rings or is struck: whether it breaks. [any]
//
// Two stages. The bound costs a product for each mode, for every blow; only a blow whose bound reaches the body's
// strength needs the true stress, at points all over the skin and at some tens of instants. Stress under a blow itself
// grows with the number of modes and depends on the striker's form (a point force has no finite stress), so points near
// the blow can be left out.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/fracture/modal_state.h"
#include "engine/modal/material_scale.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::modal {

// Stress of a body's M modes for coordinates of 1 kg^1/2 m, computed by engine/fem/surface_stress.h.
struct StressTable {
  std::vector<Vec3f> positions;  // P, object frame [m]
  // P x 3 x M: the components 11, 22 and 12 along two perpendicular tangents of the skin [Pa / (kg^1/2 m)]
  std::vector<float> stress;
  // M: S_j, the largest principal stress anywhere on the skin, tensile in one phase of the mode [Pa / (kg^1/2 m)]
  std::vector<float> largest;
};

// The factor by which all stresses of a table are multiplied in another material or size:
// stiffness / (density^1/2 size^5/2). Positions are multiplied by the size.
double stress_factor(const MaterialScale& scale);

// Returns a bound on the largest principal stress of the skin at all times from the present on [Pa], at the points of
// the table: sum_j S_j (|a_j| + c_j). A blow that begins at the present adds c_j = |b_j| min(1, pi / (omega_j tau)) /
// omega_j, so that its force is bounded while it acts, too, when it bends stiff modes that do not ring after it.
// `blow` may be null.
double stress_bound_pa(const StressTable& table, const ModalState& state, const Blow* blow);

struct StressSearch {
  int instants_during = 12;  // in the blow's contact time, evenly, up to its end; unused without a blow
  int instants_after = 48;   // after the blow, or from the present on; the first is its beginning
  double after_s = 3e-3;     // length of the time searched after the blow
  Vec3 spared_m;             // points within `spared_radius_m` of this place are left out
  double spared_radius_m = 0;
};

struct PeakStress {
  double stress_pa = 0;   // 0 when nothing is in tension
  std::size_t point = 0;  // of the table
  double time_s = 0;      // from the present, which is the blow's beginning
};

// Returns the largest principal tensile stress at the table's points. The table, the search's place and the state are
// of one size and material. `blow` begins at the state's present and may be null. Cost: 3 P M products for each
// instant, 1 to 3 ms for 300 points, 100 modes and 60 instants.
PeakStress peak_stress(const StressTable& table, const ModalState& state, const Blow* blow,
                       const StressSearch& search = {});

// The motion of a body at some instants, ascending.
struct MotionSamples {
  std::vector<double> times_s;     // T
  std::vector<float> coordinates;  // T x M [kg^1/2 m]
};

// Returns the largest stress of the first instant at which it reaches `stress_pa` anywhere on the skin but within
// `spared_radius_m` of the places `spared_m`; nothing if it never does. Cost: 3 P M products for each instant until
// then.
std::optional<PeakStress> first_reaching(const StressTable& table, const MotionSamples& samples, double stress_pa,
                                         std::span<const Vec3> spared_m, double spared_radius_m);

}  // namespace ringdown::modal
