#include "server/session/buses.h"

namespace ringdown::session {

using synth::ObjectNumber;

std::optional<std::size_t> Buses::join(ObjectNumber object, const std::string& name, const std::string& group) {
  const std::string label = mode_ == PortMode::objects ? name : mode_ == PortMode::groups ? group : "";
  const std::scoped_lock lock(mutex_);
  drop(object, label);
  if (label.empty()) return std::nullopt;
  const auto bus = bus_for(label);
  if (bus) buses_[*bus].objects.insert(object);
  overflow_ += !bus;
  return bus;
}

void Buses::leave(ObjectNumber object) {
  const std::scoped_lock lock(mutex_);
  drop(object, "");
}

void Buses::drop(ObjectNumber object, const std::string& except_label) {
  for (auto bus = buses_.begin(); bus != buses_.end(); ++bus) {
    if (bus->second.label == except_label || bus->second.objects.erase(object) == 0) continue;
    if (bus->second.objects.empty()) buses_.erase(bus);
    return;
  }
}

std::optional<std::size_t> Buses::bus_for(const std::string& label) {
  for (const auto& [number, bus] : buses_) {
    if (bus.label == label) return number;
  }
  for (std::size_t number = 0; number < synth::kMaxBuses; ++number) {
    if (buses_.contains(number)) continue;
    buses_[number].label = label;
    return number;
  }
  return std::nullopt;
}

std::map<std::size_t, std::string> Buses::names() const {
  const std::scoped_lock lock(mutex_);
  std::map<std::size_t, std::string> names;
  for (const auto& [number, bus] : buses_) names[number] = bus.label;
  return names;
}

std::size_t Buses::overflow() const {
  const std::scoped_lock lock(mutex_);
  return overflow_;
}

}  // namespace ringdown::session
