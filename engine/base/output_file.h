// Writing where the user says: to the paths of a command line or of a settings file. Paths that come in messages are
// written by write_file_atomically(), which follows nothing. [worker]
//
// A link is followed, even one whose file is still missing, and that file is replaced as a whole: a reader sees the old
// one or the new one. A device, a pipe, a socket and an open descriptor such as /dev/stdout are written to as they are.
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace ringdown {

struct OutputTarget {
  std::filesystem::path path;          // of a file: without a link at its end
  bool is_stream = false;              // what cannot be replaced by a file
  std::filesystem::path named = path;  // by the user
};

// Returns where the bytes for `path` go. Fails when links lead in a circle.
Result<OutputTarget> output_target(const std::filesystem::path& path);

// Opens a stream for writing; a pipe waits for its reader. The caller closes the descriptor.
Result<int> open_stream(const std::filesystem::path& path);

// Writes all bytes. `path` stands in the error message.
Result<void> write_stream(int descriptor, std::span<const std::byte> bytes, const std::filesystem::path& path);

Result<void> write_output(const std::filesystem::path& path, std::span<const std::byte> bytes);
Result<void> write_output(const std::filesystem::path& path, std::string_view text);

// Fails where write_output() would fail now. A stream is not tried: a pipe would wait for its reader.
Result<void> check_output(const std::filesystem::path& path);

// Makes all that a program prints go to the standard error when `path` is its standard output, so that nothing mixes
// with what is written there. Call it before anything is printed. [main]
void keep_stdout_for(const std::filesystem::path& path);

}  // namespace ringdown
