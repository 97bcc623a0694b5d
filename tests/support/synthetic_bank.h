// Banks whose modes are known without any solver. [any thread]
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/hearing/loudness.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace ringdown::test {

// The far field of the synthetic banks' modes is the same in all directions and for all of them, so that output follows
// modal acceleration: so many samples for 1 kg^1/2 m/s^2, at the default full scale. 1e-4 to rounding.
modal::FarField even_field(double frequency_hz);
inline const double kLoudness = modal::Air{}.density_kg_m3 * modal::rms(even_field(1)) / modal::kFullScale_pa;

// One mode that moves every point alike, by `shape`. Four points 1 m from the origin, a tetrahedron's surface.
modal::Bank single_mode_bank(double frequency_hz, double decay_per_s, modal::Vec3f shape = {0, 0, 1});

// The bank of single_mode_bank() with a liquid: at a height x of 0 to 0.1 m it adds kMassPerSquare x^2 to the mode's
// mass of 1, and takes kDrag x sqrt(omega) of it. The bank is of the empty body.
inline constexpr double kMassPerSquare = 300, kDrag = 0.5;
modal::Bank leveled_bank(double frequency_hz, double decay_per_s);

// A mode of a bar, which moves every point by kBarShape along z, and a tube that pulls it by kTubePull: two oscillators
// of the kind that docs/how/tubes.md describes. A motion of 1 of the tube is heard as even_field() is; one of the bar,
// with kBarSound of that, in a field like a cosine of the height. The third mode knows nothing of the tube.
struct TwoOscillators {
  double bar_hz = 220, bar_decay_per_s = 0.5, tube_hz = 220, tube_decay_per_s = 8.6, pull_rad_s = 2.5;
};
inline constexpr double kBarShape = 1.2, kBarSound = 0.02;
modal::Bank tubed_bank(const TwoOscillators& of);

// The bank of single_mode_bank(1000, 3) with air of kAir_hz in it, heard as even_field() is. Its mouth is kMouth_m
// wide.
inline constexpr double kAir_hz = 102.5, kAirDecay_per_s = 8.7, kFlux = 3e-3, kMouth_m = 0.02;
modal::Bank vessel_bank();

// The flexural modes of a free-free bar by Euler and Bernoulli: length 0.3 m along x, 20 mm x 5 mm of steel, moving
// along z; sampled at 17 points of its axis, no triangles. Material and mass properties are filled.
// Source: Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1, case 1.
modal::Bank bar_bank(std::size_t modes);

// Any number of modes between 40 Hz and 19 kHz with T60 between 50 ms and 5 s, random shapes of order 1, on a closed
// bumpy surface of at least `points` points. The same seed gives the same bank.
modal::Bank random_bank(std::uint32_t seed, std::size_t modes, std::size_t points);

inline std::shared_ptr<const modal::Bank> shared(modal::Bank bank) {
  return std::make_shared<const modal::Bank>(std::move(bank));
}

}  // namespace ringdown::test
