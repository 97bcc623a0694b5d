// What scsynth reads: a synth definition (format SCgf, version 2) and a score of OSC bundles for its non-real-time
// mode.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>

namespace ringdown::bench {

// Defines "klank", Out.ar(0, Klank.ar(..., WhiteNoise.ar * level)) with `modes` modes, and "noise", the same without
// Klank.
Result<void> write_klank_definition(const std::filesystem::path& path, std::size_t modes);

// One "noise", `synths` of "klank", and the end after `seconds`.
Result<void> write_klank_score(const std::filesystem::path& path, const std::filesystem::path& definition,
                               std::size_t synths, double seconds);

}  // namespace ringdown::bench
