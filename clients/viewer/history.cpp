#include "clients/viewer/history.h"

namespace ringdown::viewer {

void History::note(const std::string& what, protocol::Request before, protocol::Request after, double now_s) {
  entries_.resize(done_);
  if (!entries_.empty() && entries_.back().what == what && now_s - entries_.back().when_s < kOneGesture_s) {
    entries_.back().after = std::move(after);
    entries_.back().when_s = now_s;
    return;
  }
  if (entries_.size() == kMaxUndone) entries_.erase(entries_.begin());
  entries_.push_back({what, std::move(before), std::move(after), now_s});
  done_ = entries_.size();
}

std::optional<protocol::Request> History::undo() {
  if (done_ == 0) return std::nullopt;
  entries_[--done_].when_s = -kOneGesture_s;
  return entries_[done_].before;
}

std::optional<protocol::Request> History::redo() {
  if (done_ == entries_.size()) return std::nullopt;
  return entries_[done_++].after;
}

}  // namespace ringdown::viewer
