// Writing a file so that a reader sees the old one or the new one, never half of it. [worker]
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

// The whole file, refused when it is not a regular file or is larger than `limit_bytes`.
Result<std::string> read_whole_file(const std::filesystem::path& path, std::size_t limit_bytes);

// The same of a file that is open, and is closed then. `name` stands in error messages where the path would.
Result<std::string> read_open_file(int descriptor, const std::string& name, std::size_t limit_bytes);

}  // namespace ringdown
