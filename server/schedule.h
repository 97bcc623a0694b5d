// Keeps requests for a much later time, in order, until that time is near. Thus a song sent ahead, or a sender with a
// wrong clock, does not fill the mixer's short queue, which is needed for present events. [one thread]
#pragma once

#include "engine/synth/events/event.h"
#include "protocol/lanes.h"
#include "server/osc_stream.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxScheduled = 16384;  // requests

class Schedule {
 public:
  // Requests that have a frame of their own (protocol/lanes.h).
  using Request = OneOf<Types<protocol::MixerRequest, protocol::TimedWorkerRequest>>;

  struct Entry {
    synth::Frame frame = 0;
    Request request;
    std::string address;  // the address of the message, for the answer if the request fails
    Peer from;
    std::uint64_t order = 0;  // requests of one frame are taken in the order in which they were added
  };

  // Returns false, and changes nothing, when kMaxScheduled requests are waiting.
  [[nodiscard]] bool add(Entry entry) {
    if (entries_.size() == kMaxScheduled) return false;
    entry.order = next_order_++;
    entries_.push_back(std::move(entry));
    std::ranges::push_heap(entries_, later);
    return true;
  }

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool is_due(synth::Frame frame) const { return !entries_.empty() && entries_.front().frame < frame; }

  // Removes and returns the earliest request. There must be one.
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
