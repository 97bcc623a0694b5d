#include "clients/viewer/link/file_browser.h"

#include <algorithm>

namespace ringdown::viewer {

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
