// Directivity as a picture: a balloon, and polar plots in the planes of the body's axes. [any]
#pragma once

#include "clients/cli/picture/canvas.h"
#include "clients/cli/picture/directivity.h"

#include <string>

namespace ringdown::cli {

// Returns the file's bytes; empty if there was no memory for the picture.
std::string draw_directivity(Canvas::Kind kind, const modal::Bank& bank, const Directivity& directivity,
                             const std::string& title);

}  // namespace ringdown::cli
