// A bank at a glance: four mode shapes, the spectrum of a blow, how long each mode rings, and the pieces into which the
// body breaks, if it can. [any]
#pragma once

#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/canvas.h"
#include "engine/modal/bank.h"

#include <string>

namespace ringdown::cli {

inline constexpr double kPictureWidth = 1120, kPictureHeight = 900, kPiecesHeight = 300, kSmallWidth = 480,
                        kSmallHeight = 200;

// The picture of a body that breaks is higher by kPiecesHeight. Returns the file's bytes; empty if it could not be
// drawn. `small` selects one shape and the spectrum.
std::string draw_bank(Canvas::Kind kind, const modal::Bank& bank, const Answer& answer, bool small = false);

// The picture's spectrum and decays alone, as an SVG; empty if it could not be drawn.
std::string draw_answer(const modal::Bank& bank, const Answer& answer);

}  // namespace ringdown::cli
