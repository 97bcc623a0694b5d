#include "clients/viewer/link/file_browser.h"

#include <algorithm>
#include <filesystem>

namespace ringdown::viewer {

std::vector<std::string> names_of(const std::vector<std::string>& paths) {
  std::map<std::string, int> stems, in_folders;
  const auto stem = [](const std::string& path) { return std::filesystem::path(path).stem().string(); };
  const auto in_folder = [&](const std::string& path) {
    return stem(path) + " (" + std::filesystem::path(path).parent_path().filename().string() + ")";
  };
  for (const std::string& path : paths) ++stems[stem(path)], ++in_folders[in_folder(path)];
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    const bool is_alone = stems[stem(path)] == 1, is_alone_there = in_folders[in_folder(path)] == 1;
    const std::string whole = stem(path) + " (" + std::filesystem::path(path).parent_path().string() + ")";
    names.push_back(is_alone ? stem(path) : is_alone_there ? in_folder(path) : whole);
  }
  return names;
}

void FileBrowser::on(const protocol::BrowseReply& reply) {
  if (answer_.complete) return;
  if (answer_.files && *answer_.files != reply.files) answer_.found.clear();
  answer_.files = reply.files;
  finish();
}

void FileBrowser::on(const protocol::BrowseFile& file) {
  if (answer_.complete || answer_.found.size() == kMaxFiles) return;
  answer_.found.insert_or_assign(file.number, file);
  finish();
}

void FileBrowser::finish() {
  if (!answer_.files) return;
  if (answer_.found.size() < std::min(static_cast<std::size_t>(std::max(0, *answer_.files)), kMaxFiles)) return;
  scenes_.clear();
  banks_.clear();
  for (const auto& [number, file] : answer_.found) {
    if (file.kind == "scene") scenes_.push_back(file.path);
    if (file.kind == "bank") banks_.push_back(file.path);
  }
  answer_ = {.complete = true};
}

void FileBrowser::add_requests(double now_s, Requests& requests) {
  if (!answer_.complete && answer_.question.due(now_s)) requests.emplace_back(protocol::Browse{});
}

}  // namespace ringdown::viewer
