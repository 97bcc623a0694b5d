// Writes a file so that a reader sees the old file or the new one, never half of it. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace ringdown {

// Writes to a temporary name in the same folder, flushes it to disk, and renames it over `path`. On failure `path`
// is untouched and the temporary file is gone.
Result<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view text);

// Fails if write_file_atomically() would fail now: the folder is missing or not writable, the name is too long, or the
// disk is full. `path` stays unchanged.
Result<void> check_writable(const std::filesystem::path& path);

// Reads the whole file. Fails when the file is not a regular one or is larger than `limit_bytes`.
Result<std::string> read_whole_file(const std::filesystem::path& path, std::size_t limit_bytes);

// Reads a file that a document in `folder` names. Also fails if the file, with all links followed, lies outside the
// folder.
Result<std::string> read_file_below(const std::filesystem::path& folder, const std::filesystem::path& relative,
                                    std::size_t limit_bytes);

// Reads the whole open file and closes it. `name` replaces the path in error messages.
Result<std::string> read_open_file(int descriptor, const std::string& name, std::size_t limit_bytes);

}  // namespace ringdown
