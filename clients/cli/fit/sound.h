// Sound files as samples of one channel. [any]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace ringdown::cli {

struct Sound {
  double sample_rate_hz = 0;
  int channels = 0;  // of the file
  std::vector<double> samples;
};

inline constexpr double kMaxSound_s = 600;

// Reads WAV, FLAC, and every other format of libsndfile; full scale is 1. `channel` counts from 1; without it the mean
// of all channels is taken.
Result<Sound> read_sound(const std::filesystem::path& path, std::optional<int> channel);

// Writes both channels of a stereo file alike: .wav (32-bit float) or .flac, which holds nothing above 1.
// Fails when `stop` is requested.
Result<void> write_sound(std::span<const double> samples, double sample_rate_hz, const std::filesystem::path& path,
                         const std::stop_token& stop);

}  // namespace ringdown::cli
