#include "engine/base/content_cache.h"

#include "engine/base/atomic_file.h"
#include "engine/base/byte_stream.h"

#include <algorithm>
#include <cstdlib>
#include <fcntl.h>
#include <sys/stat.h>
#include <utility>
#include <vector>

namespace ringdown {
namespace {

namespace fs = std::filesystem;

// The header of an entry. On a machine of the other byte order the magic number does not match.
struct Header {
  std::uint64_t magic = 0x3165686361634452;  // "RDcache1"
  ContentHash kind, key;
  std::uint64_t size = 0;
  ContentHash checksum;
  friend bool operator==(const Header&, const Header&) = default;
};

Header header_of(std::string_view kind, const ContentHash& key, std::string_view content) {
  return {.kind = hash_of(kind), .key = key, .size = content.size(), .checksum = hash_of(content)};
}

void mark_as_used(const fs::path& path) { ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0); }

struct Kept {
  fs::path path;
  std::uintmax_t bytes = 0;
  fs::file_time_type used;
};

// Returns true if a file belongs to the cache: its name is KIND-KEY, or KIND-KEY and the six letters of a file being
// written.
bool is_ours(std::string name) {
  const std::size_t dot = name.rfind('.');
  if (dot != std::string::npos && name.size() - dot == 7) name.resize(dot);
  const std::size_t dash = name.find('-');
  if (dash == std::string::npos || dash == 0 || name.size() - dash != 33) return false;
  return name.find_first_not_of("0123456789abcdef", dash + 1) == std::string::npos &&
         std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(dash),
                     [](char letter) { return letter >= 'a' && letter <= 'z'; });
}

std::vector<Kept> files_in(const fs::path& folder) {
  std::vector<Kept> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;  // another process may delete files meanwhile
    if (!is_ours(entry->path().filename().string()) || !entry->is_regular_file(gone)) continue;
    const Kept kept{entry->path(), entry->file_size(gone), entry->last_write_time(gone)};
    if (!gone) files.push_back(kept);
  }
  return files;
}

}  // namespace

fs::path ContentCache::file_of(std::string_view kind, const ContentHash& key) const {
  return folder_ / formatted("{}-{}", kind, key.text());
}

std::optional<std::string> ContentCache::find(std::string_view kind, const ContentHash& key) const {
  const fs::path path = file_of(kind, key);
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  Result<std::string> file = read_whole_file(path, max_bytes_);
  Header header;
  if (file && ByteReader(*file).get(header)) {
    file->erase(0, sizeof header);
    if (header == header_of(kind, key, *file)) {
      mark_as_used(path);
      return std::move(*file);
    }
  }
  fs::remove(path, error);
  return std::nullopt;
}

Result<void> ContentCache::store(std::string_view kind, const ContentHash& key, std::string_view content) const {
  if (content.size() > max_bytes_ / 4) return {};
  std::error_code error;
  if (!fs::exists(folder_, error)) {
    fs::create_directories(folder_, error);
    fs::permissions(folder_, fs::perms::owner_all, error);
  }
  ByteWriter file;
  file.put(header_of(kind, key, content));
  auto written = write_file_atomically(file_of(kind, key), file.bytes() + std::string(content));
  make_room();
  return written;
}

void ContentCache::make_room() const {
  std::vector<Kept> files = files_in(folder_);
  std::uintmax_t bytes = 0;
  for (const Kept& file : files) bytes += file.bytes;
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
  for (const Kept& oldest : files) {
    if (bytes <= max_bytes_) return;
    std::error_code error;
    if (fs::remove(oldest.path, error) || !error) bytes -= oldest.bytes;
  }
}

std::optional<fs::path> cache_folder() {
  const auto variable = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') return std::nullopt;
    return value;
  };
  if (const auto chosen = variable("RINGDOWN_CACHE")) return chosen;
  if (const auto xdg = variable("XDG_CACHE_HOME"); xdg && xdg->is_absolute()) return *xdg / "ringdown";
  if (const auto home = variable("HOME")) return *home / ".cache" / "ringdown";
  return std::nullopt;
}

}  // namespace ringdown
