#include "engine/base/atomic_file.h"

#include "engine/base/within_memory.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ringdown {
namespace {

std::string system_message() { return std::strerror(errno); }

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) {
    return fail(ErrorKind::input_output, "cannot write {}: {}; choose a folder you may write to", path.string(),
                system_message());
  }
  const bool stored = write_all(descriptor, bytes) && ::fchmod(descriptor, 0644) == 0 && ::fsync(descriptor) == 0;
  const std::string reason = stored ? "" : system_message();
  ::close(descriptor);
  if (!stored || ::rename(temporary.c_str(), path.c_str()) != 0) {
    const std::string why = stored ? system_message() : reason;
    ::unlink(temporary.c_str());
    return fail(ErrorKind::input_output, "cannot write {}: {}; the old file, if any, is unchanged", path.string(), why);
  }
  return {};
}

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text)));
}

Result<void> check_writable(const std::filesystem::path& path) {
  constexpr std::size_t kPage = 4096;  // a full disk still accepts an empty file, but not a page
  const std::string page(kPage, '\0');
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(temporary.data());
  const bool good = descriptor >= 0 && write_all(descriptor, std::as_bytes(std::span(page)));
  const std::string reason = good ? "" : system_message();
  if (descriptor >= 0) {
    ::close(descriptor);
    ::unlink(temporary.c_str());
  }
  if (good) return {};
  return fail(ErrorKind::input_output, "cannot write {}: {}; choose another file", path.string(), reason);
}

Result<std::string> read_whole_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return fail(ErrorKind::bad_input, "cannot open {}: {}", path.string(), system_message());
  return read_open_file(descriptor, path.string(), limit_bytes);
}

Result<std::string> read_file_below(const std::filesystem::path& folder, const std::filesystem::path& relative,
                                    std::size_t limit_bytes) {
  std::error_code error;
  const std::filesystem::path within = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), error);
  const std::filesystem::path file = std::filesystem::weakly_canonical(within / relative, error);
  if (error || std::mismatch(within.begin(), within.end(), file.begin(), file.end()).first != within.end()) {
    return fail(ErrorKind::bad_input,
                "cannot open {}: it lies outside of the folder {}; put what a file names beside it",
                (folder / relative).string(), within.string());
  }
  return read_whole_file(file, limit_bytes);
}

Result<std::string> read_open_file(int descriptor, const std::string& name, std::size_t limit_bytes) {
  struct stat status {};
  std::string text;
  Result<void> outcome;
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    outcome = fail(ErrorKind::bad_input, "cannot read " + name + ": it is not a regular file");
  } else if (static_cast<std::size_t>(status.st_size) > limit_bytes) {
    outcome = fail(ErrorKind::too_large, "cannot read {}: {} bytes is more than the limit of {}", name, status.st_size,
                   limit_bytes);
  } else {
    outcome = within_memory("read " + name, [&]() -> Result<void> {
      text.resize(static_cast<std::size_t>(status.st_size));
      return {};
    });
    std::size_t filled = 0;
    while (filled < text.size()) {
      const ssize_t got = ::read(descriptor, text.data() + filled, text.size() - filled);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) {
        outcome = fail(ErrorKind::input_output, "cannot read {}: {}", name,
                       got < 0 ? system_message() : "it shrank while it was read");
        break;
      }
      filled += static_cast<std::size_t>(got);
    }
  }
  ::close(descriptor);
  if (!outcome) return fail(outcome);
  return text;
}

}  // namespace ringdown
