// Assigns objects to the mixer's buses, and names the buses. A bus becomes an output port.
//
// The port mode decides an object's label: the object's own name, its group's name, or none. Objects of one label share
// a bus, which exists as long as one of these objects does. When a bus comes or goes, the others keep their numbers.
// [any thread but audio]
#pragma once

#include "engine/synth/events/event.h"
#include "engine/synth/mixer.h"

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace ringdown::session {

enum class PortMode { mix, objects, groups };

class Buses {
 public:
  // Call before any object joins.
  void set_mode(PortMode mode) { mode_ = mode; }

  // Moves the object from its present bus to that of its label, and returns the new bus; nullopt: the object is heard
  // in the mix only, because of the port mode or because all synth::kMaxBuses are taken (overflow() then grows).
  std::optional<std::size_t> join(synth::ObjectNumber object, const std::string& name, const std::string& group);
  void leave(synth::ObjectNumber object);

  // The labels of the buses that are in use, by number.
  [[nodiscard]] std::map<std::size_t, std::string> names() const;

  // Returns how many objects found no free bus.
  [[nodiscard]] std::size_t overflow() const;

 private:
  struct Bus {
    std::string label;
    std::set<synth::ObjectNumber> objects;
  };
  [[nodiscard]] std::optional<std::size_t> bus_for(const std::string& label);  // with the mutex
  void drop(synth::ObjectNumber object, const std::string& except_label);      // with the mutex

  PortMode mode_ = PortMode::mix;
  mutable std::mutex mutex_;  // guards all members below
  std::map<std::size_t, Bus> buses_;
  std::size_t overflow_ = 0;
};

}  // namespace ringdown::session
