#include "server/session/file_roots.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <linux/openat2.h>
#include <optional>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace ringdown::session {
namespace {

namespace fs = std::filesystem;

// With O_NONBLOCK, opening a fifo without a writer does not wait for one.
constexpr int kReadOnly = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

// The part of `path` below `root`, or nullopt if `path` is not below it. Both are absolute and without dots.
std::optional<fs::path> below(const fs::path& path, const fs::path& root) {
  const auto [at_path, at_root] = std::mismatch(path.begin(), path.end(), root.begin(), root.end());
  if (at_root != root.end() || at_path == path.end()) return std::nullopt;
  fs::path rest;
  for (auto part = at_path; part != path.end(); ++part) rest /= *part;
  return rest;
}

fs::path without_slash(fs::path path) { return path.has_filename() ? path : path.parent_path(); }

fs::path absolute_without_dots(const fs::path& path) {
  std::error_code ignored;
  return fs::absolute(path, ignored).lexically_normal();
}

int open_beneath(int folder, const fs::path& path) {
  open_how how{};
  how.flags = static_cast<std::uint64_t>(kReadOnly);
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
  return static_cast<int>(::syscall(SYS_openat2, folder, path.c_str(), &how, sizeof how));
}

tl::unexpected<Error> cannot_write(const fs::path& path, const std::string& reason) {
  return fail(ErrorKind::input_output, "cannot write {}: {}", path.string(), reason);
}

// Returns true if the regular file at `path` is empty or has the kind's mark.
bool is_of_kind(const fs::path& path, const WrittenKind& kind) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(kind.mark_at + kind.mark.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file.gcount() == 0 ? file.eof() : std::string_view(begin).substr(kind.mark_at) == kind.mark;
}

tl::unexpected<Error> cannot_open(const fs::path& path, int reason) {
  return fail(ErrorKind::bad_input, "cannot open {}: {}", path.string(), std::strerror(reason));
}

}  // namespace

Result<FileRoots> FileRoots::only(const std::vector<fs::path>& folders, Guard guard) {
  FileRoots roots;
  roots.open_everywhere_ = false;
  roots.guard_ = guard;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path given = without_slash(absolute_without_dots(folder));
    const fs::path real = fs::canonical(folder, error);
    const int descriptor = error ? -1 : ::open(real.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) {
      return fail(ErrorKind::bad_input, "cannot allow files below {}: {}", folder.string(),
                  error ? error.message() : std::strerror(errno));
    }
    roots.roots_.push_back({given, real, {new int(descriptor), [](const int* open) {
                                            ::close(*open);
                                            delete open;
                                          }}});
  }
  return roots;
}

Result<std::string> FileRoots::read(const fs::path& path, std::size_t limit_bytes) const {
  if (open_everywhere_) return read_whole_file(path, limit_bytes);
  const auto descriptor = open(path);
  if (!descriptor) return fail(descriptor);
  return read_open_file(*descriptor, path.string(), limit_bytes);
}

Result<std::string> FileRoots::read_beside(const fs::path& document, const fs::path& relative,
                                           std::size_t limit_bytes) const {
  if (open_everywhere_) return read_file_below(document.parent_path(), relative, limit_bytes);
  return read(document.parent_path() / relative, limit_bytes);
}

Result<FileRoots::Piece> FileRoots::read_piece(const fs::path& path, std::size_t offset, std::size_t max_bytes) const {
  const auto opened = open(path);
  if (!opened) return fail(opened);
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } const file{*opened};
  struct stat status {};
  if (::fstat(file.descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(ErrorKind::bad_input, "cannot read " + path.string() + ": it is not a regular file");
  }
  Piece piece{.total = static_cast<std::size_t>(status.st_size)};
  piece.bytes.resize(std::min(max_bytes, piece.total - std::min(offset, piece.total)));
  for (std::size_t filled = 0; filled < piece.bytes.size();) {
    const ssize_t got = ::pread(file.descriptor, piece.bytes.data() + filled, piece.bytes.size() - filled,
                                static_cast<off_t>(offset + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(ErrorKind::input_output, "cannot read {}: {}", path.string(), std::strerror(errno));
    if (got == 0)
      return fail(ErrorKind::input_output, "cannot read " + path.string() + ": it shrank while it was read");
    filled += static_cast<std::size_t>(got);
  }
  return piece;
}

std::vector<fs::path> FileRoots::folders() const {
  std::vector<fs::path> folders;
  for (const Root& root : roots_) folders.push_back(root.given);
  return folders;
}

Result<int> FileRoots::open(const fs::path& path) const {
  if (open_everywhere_) {
    const int descriptor = ::open(path.c_str(), kReadOnly);
    if (descriptor < 0) return cannot_open(path, errno);
    return descriptor;
  }
  const fs::path plain = absolute_without_dots(path);
  for (const Root& root : roots_) {
    for (const fs::path& start : {root.given, root.real}) {
      if (const auto rest = below(plain, start)) return open_in(root, *rest);
    }
  }
  return outside(path);
}

Result<int> FileRoots::open_in(const Root& root, const fs::path& rest) const {
  if (guard_ == Guard::kernel) {
    const int descriptor = open_beneath(*root.folder, rest);
    if (descriptor >= 0) return descriptor;
    if (errno == EXDEV) return outside(root.given / rest);
    if (errno != ENOSYS && errno != EPERM) return cannot_open(root.given / rest, errno);
  }
  std::error_code error;
  const fs::path real = fs::canonical(root.real / rest, error);
  if (error) return cannot_open(root.given / rest, error.value());
  if (!below(real, root.real)) return outside(root.given / rest);
  const int descriptor = ::open(real.c_str(), kReadOnly | O_NOFOLLOW);
  if (descriptor < 0) return cannot_open(root.given / rest, errno);
  return descriptor;
}

Result<fs::path> FileRoots::writable(const fs::path& path, const WrittenKind& kind) const {
  std::error_code error;
  const fs::path plain = absolute_without_dots(path);
  const fs::path folder = fs::canonical(plain.parent_path(), error);
  if (error) return cannot_write(path, error.message());
  const fs::path target = folder / plain.filename();
  const fs::file_status there = fs::symlink_status(target, error);
  if (!plain.has_filename() || (fs::exists(there) && !fs::is_regular_file(there))) {
    return cannot_write(path, "it is not a regular file");
  }
  const bool inside = open_everywhere_ || std::ranges::any_of(roots_, [&](const Root& root) {
                        return below(target, root.real).has_value();
                      });
  if (!inside) return outside(path);
  if (!has_ending(target, kind.ending)) {
    return cannot_write(path, "the name must end in " + std::string(kind.ending));
  }
  if (fs::exists(there) && kind.mark.empty()) {
    return cannot_write(path, "a file of that name is there already; choose another name");
  }
  if (fs::exists(there) && !is_of_kind(target, kind)) {
    return cannot_write(path, "another kind of file has this name; remove it, or choose another name");
  }
  return target;
}

tl::unexpected<Error> FileRoots::outside(const fs::path& path) const {
  std::string folders;
  for (const Root& root : roots_) folders += (folders.empty() ? "" : ", ") + root.given.string();
  return fail(ErrorKind::bad_input,
              "cannot open {}: it is outside the folders in which files may be opened ({}); name another with --root "
              "when the daemon is started",
              path.string(), folders);
}

}  // namespace ringdown::session
