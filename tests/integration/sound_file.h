// Sound files that a program wrote, as samples.
#pragma once

#include "tests/support/signal.h"

#include <filesystem>
#include <vector>

namespace ringdown::test {

// The samples of all channels, frame by frame, of the left one, or of each channel; none where there is no such file.
Samples read_frames(const std::filesystem::path& path);
Samples read_left(const std::filesystem::path& path);
std::vector<Samples> read_channels(const std::filesystem::path& path);

}  // namespace ringdown::test
