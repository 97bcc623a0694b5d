// The values of all parameters and states that the window sets, as they were before each edit, for undo and redo. [UI]
#pragma once

#include "clients/plugin/parameters.h"
#include "clients/plugin/strike_point.h"

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::plugin {

struct Values {
  std::array<float, kParameters> parameters{};
  std::string file;                         // the state of this name
  std::array<std::string, kPoints> points;  // the states kPointStates
  [[nodiscard]] float operator[](Parameter parameter) const { return parameters[static_cast<std::size_t>(parameter)]; }
};

class History {
 public:
  static constexpr std::size_t kMax = 200;  // edits; older ones are forgotten

  // Keeps the values as they are before an edit. Forgets what was taken back.
  void record(Values before) {
    if (before_.size() == kMax) before_.pop_front();
    before_.push_back(std::move(before));
    after_.clear();
  }
  [[nodiscard]] bool can_undo() const { return !before_.empty(); }
  [[nodiscard]] bool can_redo() const { return !after_.empty(); }

  // Return the values to go to; nothing if there are none. `now` are the present ones.
  std::optional<Values> undo(Values now) { return move(before_, after_, std::move(now)); }
  std::optional<Values> redo(Values now) { return move(after_, before_, std::move(now)); }

 private:
  static std::optional<Values> move(std::deque<Values>& from, std::deque<Values>& to, Values now) {
    if (from.empty()) return std::nullopt;
    to.push_back(std::move(now));
    Values target = std::move(from.back());
    from.pop_back();
    return target;
  }
  std::deque<Values> before_, after_;
};

}  // namespace ringdown::plugin
