// A folder of results, each found again by the hash of its inputs. [worker; any number of processes]
//
//   const ContentCache cache(*cache_folder());
//   if (auto kept = cache.find("modes", key)) ...use *kept...
//   else cache.store("modes", key, bytes);
//
// An entry is one file, KIND-KEY. An entry is written under another name and then renamed, so that processes may share
// the folder. Each file carries its kind, its key and a checksum of its content; a file that does not match them is
// deleted and not returned. When the folder outgrows its size, the entries unused for longest are deleted, and with
// them the half-written files of killed processes. Files of other names are never touched. Deleting the whole folder is
// safe at any time.
#pragma once

#include "engine/base/content_hash.h"
#include "engine/base/result.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace ringdown {

inline constexpr std::uintmax_t kMaxCacheBytes = std::uintmax_t{2} << 30;

class ContentCache {
 public:
  // `folder` need not exist yet.
  explicit ContentCache(std::filesystem::path folder, std::uintmax_t max_bytes = kMaxCacheBytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  // Returns the stored content, which counts as used now; nothing if there is none. `kind` is a word of lower-case
  // letters.
  [[nodiscard]] std::optional<std::string> find(std::string_view kind, const ContentHash& key) const;

  // Stores content, replacing an older entry of this kind and key. Content larger than a quarter of the folder's size
  // is not kept.
  Result<void> store(std::string_view kind, const ContentHash& key, std::string_view content) const;

 private:
  [[nodiscard]] std::filesystem::path file_of(std::string_view kind, const ContentHash& key) const;
  void make_room() const;

  std::filesystem::path folder_;
  std::uintmax_t max_bytes_;
};

// Returns $RINGDOWN_CACHE, else $XDG_CACHE_HOME/ringdown, else ~/.cache/ringdown; nothing if none of the variables is
// set. A relative XDG_CACHE_HOME is ignored, as the XDG base directory specification asks.
std::optional<std::filesystem::path> cache_folder();

}  // namespace ringdown
