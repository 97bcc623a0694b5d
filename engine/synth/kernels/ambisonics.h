// Ambisonics: the sound field at the listener, as a sum of spherical harmonics, in the AmbiX convention: channels in
// ACN order, SN3D normalisation. Any AmbiX decoder for loudspeakers or headphones reads it.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

inline constexpr std::size_t kMaxAmbisonicOrder = 3;

constexpr std::size_t ambisonic_channels(std::size_t order) { return (order + 1) * (order + 1); }
inline constexpr std::size_t kMaxAmbisonicChannels = ambisonic_channels(kMaxAmbisonicOrder);

using AmbisonicGains = std::array<double, kMaxAmbisonicChannels>;

// Returns the gain of a source at each channel. `towards` is the unit vector from the listener to the source: x to the
// front, y to the left, z up. With a shorter vector the sound comes less from that direction and more from all around.
// [any]
AmbisonicGains encode(Vec3 towards) REALTIME;

}  // namespace ringdown::synth
