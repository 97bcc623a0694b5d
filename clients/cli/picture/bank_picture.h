// A bank at a glance: four mode shapes, the spectrum of a blow, and how long each mode rings. [any]
#pragma once

#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/canvas.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

inline constexpr double kPictureWidth = 1120, kPictureHeight = 900, kSmallWidth = 480, kSmallHeight = 200;

// Returns the file's bytes; empty if it could not be drawn. `small` selects one shape and the spectrum.
std::string draw_bank(Canvas::Kind kind, const modal::Bank& bank, const Answer& answer, bool small = false);

}  // namespace ringdown::cli
