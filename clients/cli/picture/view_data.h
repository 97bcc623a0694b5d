// A bank as text for the page's own scripts: its surface, its mode shapes and what makes them sound, as numbers and as
// small integers in base64. [any]
#pragma once

#include "engine/modal/bank.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::cli {

inline constexpr std::size_t kMaxShapeBytes = 420'000;  // pages of all presets are then below 1 MB
inline constexpr std::size_t kMinPlaces = 16;

// The sample points whose shapes the page has: all of them, or, if they would take more than kMaxShapeBytes, points
// that lie as evenly as possible, at least kMinPlaces. Ascending.
std::vector<std::uint16_t> places_of(const modal::Bank& bank);

// Returns JSON; {} if the surface has more than kMaxDrawn triangles or points.
//
//   modes                     M
//   points, triangles         16-bit: all P sample points, in units of unit_m about middle_m; numbers of points
//   places                    16-bit: places_of(), K numbers of points
//   shapes                    16-bit, M x K x 3: displacements in units of shape_unit[m]
//   unit_m, middle_m, shape_unit
//   frequency_hz, decay_per_s M, rounded to floats like the bank's own
//   output                    M: the sample value, full scale being 1, that a modal velocity of 1 kg^1/2 m/s gives 1 m
//                             away, rms over directions, after what a metre of air absorbs
//   radiation                 the maps of radiation as in a bank's file; absent if the bank has none
//   nonlinear                 whether a hard blow sounds different, which the page does not render
std::string view_data(const modal::Bank& bank);

}  // namespace ringdown::cli
