#include "server/session/observers.h"

#include <algorithm>

namespace ringdown::session {

using synth::Event;

void Observers::keep(synth::Producer producer, const Event& event) {
  if (observers_.empty() || played_by(producer).push(event)) return;
  if (std::ranges::none_of(observers_, &Observer::needs_events)) return;
  report_events();
  static_cast<void>(played_by(producer).push(event));
}

void Observers::report_events() {
  const std::scoped_lock lock(reporting_);
  for (auto& ring : played_) {
    while (const Event* event = ring.front()) {
      for (Observer* observer : observers_) observer->played(*event);
      ring.pop();
    }
  }
}

void Observers::report_change(const ObjectState* before, const ObjectState* after, synth::Frame at) {
  report_change();
  for (Observer* observer : observers_) observer->changed(before, after, at);
}

void Observers::report_broken(const BrokenObject& object) {
  for (Observer* observer : observers_) observer->broke(object);
}

void Observers::report_change() {
  ++version_;
  if (on_change_) on_change_();
}

}  // namespace ringdown::session
