// Writes to the paths that a user gives on a command line or in a settings file. Paths that come in messages are
// written by write_file_atomically(), which follows no links. [worker]
//
// A link is followed, even if its file does not exist yet, and the file is replaced as a whole: a reader sees the old
// file or the new one. Devices, pipes, sockets and open descriptors such as /dev/stdout are written to directly.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace ringdown {

struct OutputTarget {
  std::filesystem::path path;          // the path to write to; a file's path does not end in a link
  bool is_stream = false;              // true: a device, pipe, socket or descriptor, which no file can replace
  std::filesystem::path named = path;  // the path that the user gave
};

// Returns where the bytes for `path` go. Fails when links lead in a circle.
Result<OutputTarget> output_target(const std::filesystem::path& path);

// Opens a stream for writing; a pipe waits for its reader. The caller closes the descriptor.
Result<int> open_stream(const std::filesystem::path& path);

// Writes all bytes. `path` appears in the error message.
Result<void> write_stream(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path);

Result<void> write_output(const std::filesystem::path& path, std::span<const std::byte> bytes);
Result<void> write_output(const std::filesystem::path& path, std::string_view text);

// Fails if write_output() would fail now. Streams are not tested, because a pipe would wait for its reader.
Result<void> check_output(const std::filesystem::path& path);

// If `path` is the program's standard output, redirects everything that the program prints to standard error, so that
// messages do not mix with the output. Call before anything is printed. [main]
void keep_stdout_for(const std::filesystem::path& path);

}  // namespace ringdown
