// Which object is heard at which of the mixer's buses, and what the buses are called. A bus becomes an output port.
//
// An object's label is its own name, its group's name, or none, by the port mode. Objects of one label share a bus,
// which exists as long as one of these objects does. Other buses keep their places when one comes or goes. [any thread
// but audio]
#pragma once

#include "engine/synth/event.h"
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
  // Before any object.
  void set_mode(PortMode mode) { mode_ = mode; }

  // Takes the object from the bus it had and returns its bus; nullopt: the object is heard in the mix only, because of
  // the port mode or because all synth::kMaxBuses are taken (overflow() then grows).
  std::optional<std::size_t> join(synth::ObjectNumber object, const std::string& name, const std::string& group);
  void leave(synth::ObjectNumber object);

  // The labels of the buses that are in use.
  [[nodiscard]] std::map<std::size_t, std::string> names() const;

  // How often an object found no free bus.
  [[nodiscard]] std::size_t overflow() const;

 private:
  struct Bus {
    std::string label;
    std::set<synth::ObjectNumber> objects;
  };
  [[nodiscard]] std::optional<std::size_t> bus_for(const std::string& label);  // with the mutex
  void drop(synth::ObjectNumber object, const std::string& but_not_label);     // with the mutex

  PortMode mode_ = PortMode::mix;
  mutable std::mutex mutex_;  // guards what follows
  std::map<std::size_t, Bus> buses_;
  std::size_t overflow_ = 0;
};

}  // namespace ringdown::session
