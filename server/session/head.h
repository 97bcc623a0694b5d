// Reads a head's impulse responses from a SOFA file (AES69) as filters for ambisonic channels. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/synth/output/binaural.h"

#include <filesystem>

namespace ringdown::session {

// Reads a SOFA file; an empty path means the head in libmysofa's package (MIT's KEMAR). The returned loader computes
// filters for any sample rate from 8 kHz on, in about a second the first time.
//
// Below 2 kHz the filters reproduce the head's responses in all directions with the least squared error. Above 2 kHz
// ambisonics of order 3 cannot carry phases between the ears, so only the magnitudes are reproduced (Schörkhuber,
// Zaunschirm & Höldrich, "Binaural rendering of ambisonic signals via magnitude least squares", DAGA 2018). Averaged
// over directions, the two ears get the energy of left and right in the stereo mix.
Result<synth::HeadLoader> read_head(const std::filesystem::path& sofa);

}  // namespace ringdown::session
