// A question of the window to the daemon. Datagrams get lost, so every question is repeated until it is answered. [one
// thread: the window's]
#pragma once

#include "protocol/request.h"

#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

using Requests = std::vector<protocol::Request>;

inline protocol::ObjectRef object_named(const std::string& name) { return {name, std::nullopt}; }

// Remembers when a question was last asked. The receiver of the answer must stop asking.
class Question {
 public:
  static constexpr double kPatience_s = 0.5;  // the usual time to wait for an answer

  // Returns whether to ask now: the first time, and whenever `patience_s` have passed since the last time. If so,
  // counts the question as asked.
  bool due(double now_s, double patience_s = kPatience_s) {
    if (asked_at_s_ && now_s - *asked_at_s_ <= patience_s) return false;
    asked_at_s_ = now_s;
    return true;
  }

 private:
  std::optional<double> asked_at_s_;
};

}  // namespace ringdown::viewer
