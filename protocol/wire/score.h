// OSC scores: files of timed messages, the format that scsynth's non-real-time mode reads. [worker]
//
// A file is a sequence of bundles, each after its length as a big-endian int32. A bundle's timetag is the time since
// the start, in NTP's fixed point (32 bits of seconds, 32 of fraction). sclang's Score, supriya and others write such
// files.
#pragma once

#include "engine/base/result.h"
#include "protocol/wire/message.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace ringdown::wire {

inline constexpr std::size_t kMaxScoreBytes = std::size_t{256} << 20;  // bytes
inline constexpr double kMaxScore = 86400;                             // s: a day

// Returns the messages by time; messages at one time are in the file's order. An error names the file, the fault, and
// the bundle by number and byte; a fault in any bundle refuses the whole file.
Result<std::vector<ScoreEvent>> read_score(const std::filesystem::path& path);

// Reads a score from memory. `name` replaces the path in error messages.
Result<std::vector<ScoreEvent>> parse_score(std::span<const std::byte> bytes, const std::string& name);

// Encodes a score, with one bundle for each run of events at one time. `events` must be in order of time, from 0 to
// kMaxScore. Times are rounded to 2^-32 s.
std::vector<std::byte> encode_score(std::span<const ScoreEvent> events);
Result<void> write_score(std::span<const ScoreEvent> events, const std::filesystem::path& path);

}  // namespace ringdown::wire
