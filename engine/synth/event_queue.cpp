#include "engine/synth/event_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace ringdown::synth {

std::size_t EventQueue::accept(Frame now) RINGDOWN_REALTIME {
  std::size_t late = 0;
  placed_ = 0;
  for (Ring& ring : rings_) {
    for (; count_ < kMaxPendingEvents && placed_ < kMaxPlacings; ring.pop()) {
      const Event* event = ring.front();
      if (!event) break;
      late += take(*event, now);
    }
  }
  return late;
}

// A binary heap by frame, and among events of one frame by the order in which they came. The audio thread moves events
// into it from the rings at each chunk; what finds it full stays in its ring, so nothing is lost.
//
// Returns true when the event was late.
bool EventQueue::take(const Event& event, Frame now) RINGDOWN_REALTIME {
  if (is_placing(event)) {
    Event& placing = placings_.data()[placed_++];
    placing = event;
    placing.frame = std::max(event.frame, now);
    return false;
  }
  Pending* const heap = heap_.data();
  heap[count_] = {event, next_order_++};
  heap[count_].event.frame = std::max(event.frame, now);
  ++count_;
  std::push_heap(heap, heap + count_, Later{});
  return event.frame < now;
}

// All events leave the rings, even past kMaxPendingEvents, because those in the rings count the old frames too.
std::size_t EventQueue::rescale(Frame now, double ratio) {
  std::size_t late = 0;
  for (Ring& ring : rings_) {
    for (; const Event* event = ring.front(); ring.pop()) {
      heap_.resize(std::max(heap_.size(), count_ + 1));
      if (placed_ == kMaxPlacings) placed_ = 0;  // older places do not matter
      late += take(*event, now);
    }
  }
  const auto begin = heap_.begin(), end = begin + static_cast<std::ptrdiff_t>(count_);
  std::sort(begin, end, [](const Pending& a, const Pending& b) { return Later{}(b, a); });
  next_order_ = 0;  // two frames may become one; their events keep their order
  std::for_each(begin, end, [&](Pending& pending) {
    const double ahead = static_cast<double>(pending.event.frame - now) * ratio;
    pending.event.frame = now + static_cast<Frame>(std::llround(ahead));
    pending.order = next_order_++;
  });
  return late;
}

void EventQueue::pop() RINGDOWN_REALTIME {
  std::pop_heap(heap_.data(), heap_.data() + count_, Later{});
  --count_;
}

void EventQueue::put_back(const Pending& pending) RINGDOWN_REALTIME {
  assert(count_ < heap_.size());
  heap_.data()[count_++] = pending;
  std::push_heap(heap_.data(), heap_.data() + count_, Later{});
}

}  // namespace ringdown::synth
