// A head to listen with: its impulse responses from a SOFA file (AES69), as filters for ambisonic channels. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/synth/output/binaural.h"

#include <filesystem>

namespace ringdown::session {

// Reads a SOFA file; an empty path stands for the head that libmysofa brings (MIT's KEMAR). The loader that is returned
// computes filters for any sample rate from 8 kHz on, in about a second the first time.
//
// Below 2 kHz the filters reproduce the head's responses in all directions with the least squared error; above, where
// ambisonics of order 3 cannot carry phases between the ears, only their magnitudes (Schörkhuber, Zaunschirm &
// Höldrich, "Binaural rendering of ambisonic signals via magnitude least squares", DAGA 2018). Averaged over directions
// the two ears get the energy that left and right of the stereo mix get.
Result<synth::HeadLoader> read_head(const std::filesystem::path& sofa);

}  // namespace ringdown::session
