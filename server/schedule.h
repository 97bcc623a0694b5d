// Requests whose time is far: kept here, in order, until the mixer's own short queue should have them.
//
// So that a song sent ahead, or a sender with a wrong clock, takes no room from what happens now. [one thread]
#pragma once

#include "engine/synth/event.h"
#include "protocol/lanes.h"
#include "server/osc_ports.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxScheduled = 16384;  // requests

class Schedule {
 public:
  // Those that happen at a frame of their own (protocol/lanes.h).
  using Request = std::variant<protocol::MixerRequest, protocol::TimedWorkerRequest>;

  struct Entry {
    synth::Frame frame = 0;
    Request request;
    std::string address;  // as it was sent, for the answer if it fails
    Peer from;
    std::uint64_t order = 0;  // among those of one frame: first come, first played
  };

  // False when kMaxScheduled are waiting; nothing changes then.
  [[nodiscard]] bool add(Entry entry) {
    if (entries_.size() == kMaxScheduled) return false;
    entry.order = next_order_++;
    entries_.push_back(std::move(entry));
    std::ranges::push_heap(entries_, later);
    return true;
  }

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool is_due(synth::Frame frame) const { return !entries_.empty() && entries_.front().frame < frame; }

  // The earliest; there must be one.
  Entry take() {
    std::ranges::pop_heap(entries_, later);
    Entry entry = std::move(entries_.back());
    entries_.pop_back();
    return entry;
  }

 private:
  static bool later(const Entry& a, const Entry& b) {
    return a.frame != b.frame ? a.frame > b.frame : a.order > b.order;
  }
  std::vector<Entry> entries_;  // a heap, earliest first
  std::uint64_t next_order_ = 0;
};

}  // namespace ringdown::server
