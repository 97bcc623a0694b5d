#include "server/browse.h"

#include "engine/base/file_format.h"

#include <algorithm>
#include <set>
#include <string>
#include <system_error>
#include <utility>

namespace ringdown::server {
namespace {

namespace fs = std::filesystem;

const std::string kScene = "scene", kBank = "bank";

struct Kinds {
  std::set<std::string> scenes, banks;
  std::set<fs::path> seen;  // paths without links, because roots may contain each other or be given twice
};

// The shortest path to the file from the current folder.
std::string shown(const fs::path& path, const fs::path& here) {
  const fs::path near = path.lexically_relative(here);
  return near.empty() || *near.begin() == ".." ? path.string() : near.string();
}

void look_at(const fs::directory_entry& entry, const fs::path& here, Kinds& found) {
  std::error_code error;
  if (!entry.is_regular_file(error) || entry.is_symlink(error)) return;
  const bool is_scene = is_of_kind(entry.path(), FileKind::table) && entry.path().parent_path().filename() == "scenes";
  if (!is_scene && !has_ending(entry.path(), ".glb")) return;
  const fs::path real = fs::canonical(entry.path(), error);
  if (error || !found.seen.insert(real).second) return;
  (is_scene ? found.scenes : found.banks).insert(shown(entry.path(), here));
}

// Folders that are gone or not ours are skipped; an error is one of the system, like a lack of file descriptors.
Result<void> look_below(const fs::path& root, const fs::path& here, Kinds& found) {
  std::error_code error;
  fs::recursive_directory_iterator at(root, fs::directory_options::skip_permission_denied, error);
  for (std::size_t n = 0; !error && at != fs::recursive_directory_iterator() && n < kMaxLookedAt; ++n) {
    const bool hidden = at->path().filename().string().starts_with('.');
    if (hidden || at.depth() >= kMaxBrowseDepth) at.disable_recursion_pending();
    if (!hidden) look_at(*at, here, found);
    at.increment(error);
  }
  if (!error || error == std::errc::no_such_file_or_directory || error == std::errc::permission_denied) return {};
  return fail(ErrorKind::input_output, "cannot look for files in {}: {}", root.string(), error.message());
}

}  // namespace

Result<std::vector<protocol::BrowseFile>> browse(const session::FileRoots& roots) {
  std::error_code ignored;
  const fs::path here = fs::current_path(ignored);
  Kinds found;
  for (const fs::path& folder : roots.folders()) {
    if (const auto looked = look_below(folder, here, found); !looked) return fail(looked);
  }
  std::vector<protocol::BrowseFile> files;
  for (const auto& [kind, paths] : {std::pair(&kScene, &found.scenes), std::pair(&kBank, &found.banks)}) {
    for (const std::string& path : *paths) {
      if (files.size() == kMaxBrowsed) return files;
      files.push_back({static_cast<std::int32_t>(files.size()), *kind, path});
    }
  }
  return files;
}

}  // namespace ringdown::server
