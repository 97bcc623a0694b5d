// Undo and redo: each entry is what to send to the daemon to go back, and what to send to go forward again. [UI]
#pragma once

#include "protocol/request.h"

#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

inline constexpr std::size_t kMaxUndone = 256;  // older changes are forgotten

class History {
 public:
  // A change of `what` ("bell: stiffness"), already sent. One that follows a change of the same thing within
  // kOneGesture_s joins it: a slider that is dragged is one change.
  void note(const std::string& what, protocol::Request before, protocol::Request after, double now_s);

  static constexpr double kOneGesture_s = 0.7;

  // What to send; nothing when there is no change (left).
  std::optional<protocol::Request> undo();
  std::optional<protocol::Request> redo();

  // What undo() and redo() would change; empty for nothing.
  [[nodiscard]] std::string undoes() const { return done_ == 0 ? "" : entries_[done_ - 1].what; }
  [[nodiscard]] std::string redoes() const { return done_ == entries_.size() ? "" : entries_[done_].what; }

  void clear() { entries_.clear(), done_ = 0; }

 private:
  struct Entry {
    std::string what;
    protocol::Request before, after;
    double when_s;
  };
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  // those before are done, the others undone
};

}  // namespace ringdown::viewer
