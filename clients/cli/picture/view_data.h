// A bank's surface and mode shapes as text for the page's own 3-D view: small integers in base64. [any]
#pragma once

#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

inline constexpr std::size_t kMaxViewBytes = std::size_t{4} << 20;  // of shapes; later modes are left out

// JSON: points (16-bit, of 32000 the body's largest extent), triangles (32-bit), shapes (8-bit, of 127 each mode's
// largest component), and how many modes have one. {} when the surface has more than kMaxDrawn triangles or points.
std::string view_data(const modal::Bank& bank);

}  // namespace ringdown::cli
