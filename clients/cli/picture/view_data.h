// A bank's surface and mode shapes as text for the page's own 3-D view: small integers in base64. [any]
#pragma once

#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

inline constexpr std::size_t kMaxViewBytes = std::size_t{4} << 20;  // bytes of shapes; later modes are left out

// Returns JSON: points (16-bit; 32000 is the body's largest extent), triangles (32-bit), shapes (8-bit; 127 is each
// mode's largest component), and the number of modes with a shape. {} if the surface has more than kMaxDrawn triangles
// or points.
std::string view_data(const modal::Bank& bank);

}  // namespace ringdown::cli
