// The values that the window shows, and its ways to change them: each edit reaches the host, and can be undone. [UI]
#pragma once

#include "clients/plugin/strike_point.h"
#include "clients/plugin/window/history.h"
#include "clients/plugin/window/host_link.h"

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::plugin {

class Edits {
 public:
  explicit Edits(HostLink& host);

  [[nodiscard]] const Values& values() const { return values_; }
  [[nodiscard]] const History& history() const { return history_; }

  // The host reports these.
  void on_parameter(std::size_t parameter, float value);
  void on_point(Which which, const std::string& text) { values_.points[static_cast<std::size_t>(which)] = text; }
  void on_file(const std::string& path) { values_.file = path; }

  // The user edits by these. A slider is begun, moved and ended; every other edit is one step.
  void begin(Parameter parameter);
  void move(Parameter parameter, double value);
  void end(Parameter parameter);
  void set(Parameter parameter, double value);
  void set(std::initializer_list<std::pair<Parameter, double>> values);  // in one step
  void set_point(const StrikePoint& point, Which which = Which::first);
  void play_file(const std::string& path);  // and chooses it as object
  void undo() { go_to(history_.undo(values_)); }
  void redo() { go_to(history_.redo(values_)); }

  // Returns an exact strike point, if it is used for an object of this source.
  [[nodiscard]] std::optional<StrikePoint> point_on(const std::string& source, Which which = Which::first) const;

 private:
  void send(std::size_t parameter, float value);
  void go_to(const std::optional<Values>& target);

  HostLink& host_;
  Values values_;
  History history_;
};

}  // namespace ringdown::plugin
