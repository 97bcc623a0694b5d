#include "engine/base/output_file.h"

#include "engine/base/atomic_file.h"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace ringdown {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as many as the kernel follows

tl::unexpected<Error> cannot_write(const fs::path& path, int reason) {
  return fail(ErrorKind::input_output, "cannot write {}: {}", path.string(), std::strerror(reason));
}

// Returns the descriptor of this process that `path` stands for: 1 for /proc/self/fd/1, to which /dev/stdout leads.
std::optional<int> own_descriptor(const fs::path& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(path.parent_path(), error);
  if (error || folder != formatted("/proc/{}/fd", ::getpid())) return std::nullopt;
  const std::string name = path.filename();
  int number = -1;
  const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), number);
  return wrong == std::errc() && *end == '\0' ? std::optional(number) : std::nullopt;
}

// Follows links one by one up to the first path that is not a link or is a descriptor.
Result<fs::path> followed(const fs::path& path) {
  fs::path at = path;
  for (int links = 0; links <= kMaxLinks; ++links) {
    std::error_code error;
    if (own_descriptor(at) || !fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path next = fs::read_symlink(at, error);
    if (error) return cannot_write(path, error.value());
    at = at.parent_path() / next;  // an absolute path replaces the whole path before it
  }
  return cannot_write(path, ELOOP);
}

int connect_to(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path) return errno = ENAMETOOLONG, -1;
  std::strcpy(address.sun_path, path.c_str());
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return descriptor;
  }
  const int reason = errno;
  ::close(descriptor);
  return errno = reason, -1;
}

}  // namespace

Result<OutputTarget> output_target(const fs::path& path) {
  auto target = followed(path);
  if (!target) return fail(target);
  std::error_code error;
  const fs::file_status status = fs::status(*target, error);
  const bool is_file = !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status);
  return OutputTarget{*target, own_descriptor(*target).has_value() || !is_file, path};
}

Result<int> open_stream(const fs::path& path) {
  const auto own = own_descriptor(path);
  std::error_code error;
  int descriptor = -1;
  if (own) {
    descriptor = ::fcntl(*own, F_DUPFD_CLOEXEC, 0);
  } else if (fs::is_socket(path, error)) {
    descriptor = connect_to(path);
  } else {
    descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  }
  if (descriptor < 0) return cannot_write(path, errno);
  return descriptor;
}

Result<void> write_stream(int descriptor, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return cannot_write(path, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> write_output(const fs::path& path, std::span<const std::byte> bytes) {
  const auto target = output_target(path);
  if (!target) return fail(target);
  if (!target->is_stream) return write_file_atomically(target->path, bytes);
  const auto descriptor = open_stream(target->path);
  if (!descriptor) return fail(descriptor);
  const auto written = write_stream(*descriptor, bytes, path);
  ::close(*descriptor);
  return written;
}

Result<void> write_output(const fs::path& path, std::string_view text) {
  return write_output(path, std::as_bytes(std::span(text)));
}

Result<void> check_output(const fs::path& path) {
  const auto target = output_target(path);
  if (!target) return fail(target);
  return target->is_stream ? Result<void>() : check_writable(target->path);
}

void keep_stdout_for(const fs::path& path) {
  struct stat named {
  }, standard{};
  const auto target = output_target(path);
  if (!target || !target->is_stream || ::fstat(STDOUT_FILENO, &standard) != 0) return;
  const auto own = own_descriptor(target->path);
  if ((own ? ::fstat(*own, &named) : ::stat(target->path.c_str(), &named)) != 0) return;
  if (named.st_dev == standard.st_dev && named.st_ino == standard.st_ino) stdout = stderr;  // a variable in glibc
}

}  // namespace ringdown
