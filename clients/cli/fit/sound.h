// Sound files as samples of one channel. [any]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace ringdown::cli {

struct Sound {
  double sample_rate_hz = 0;
  int channels = 0;  // channels in the file
  std::vector<double> samples;
  std::string note;  // a sentence about channels that were left out; else empty
};

inline constexpr double kMaxSound_s = 600;

// Reads WAV, FLAC, and every other format of libsndfile; full scale is 1. A WAV file without a data length in its
// header, as written by a program into a pipe, is read to its end. `channel` counts from 1. Without `channel`, the mean
// of all channels that are not silent is used, or the loudest one alone if they cancel each other. Fails on files that
// cannot be read, are empty, are longer than kMaxSound_s, are silent, or have a sample that is not a number; each has
// its own sentence.
Result<Sound> read_sound(const std::filesystem::path& path, std::optional<int> channel);

// Writes the samples to both channels of a stereo file: .wav (32-bit float) or .flac, which holds nothing above 1.
// Fails if `stop` is requested.
Result<void> write_sound(std::span<const double> samples, double sample_rate_hz, const std::filesystem::path& path,
                         const std::stop_token& stop);

}  // namespace ringdown::cli
