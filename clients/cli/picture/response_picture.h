// A frequency response as a picture: magnitude and phase over frequency, and Nyquist's curve; of an energy the
// magnitude alone. [any]
#pragma once

#include "clients/cli/picture/canvas.h"
#include "clients/cli/picture/response_table.h"

#include <string>

namespace ringdown::cli {

// Returns the file's bytes; empty if there was no memory for the picture.
std::string draw_response(Canvas::Kind kind, const ResponseTable& table);

}  // namespace ringdown::cli
