#include "engine/synth/events/event_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace ringdown::synth {
namespace {

template <class One>
constexpr bool kWaitsInside = sizeof(One) <= QueuedEvent::kSmallVerb;

}  // namespace

// The audio thread adds to `free` only what was taken from it, so that until now nobody has.
void EventQueue::Lane::make_room() {
  if (!large.empty()) return;
  large = std::vector<Large>(places);
  for (std::size_t i = 0; i < large.size(); ++i) static_cast<void>(free.push(static_cast<std::uint16_t>(i)));
}

bool EventQueue::push(Producer producer, const Event& event) REALTIME {
  Lane& lane = lanes_[static_cast<std::size_t>(producer)];
  QueuedEvent queued;
  queued.frame = event.frame;
  queued.object = event.object;
  queued.verb = static_cast<std::uint8_t>(event.verb.index());
  queued.producer = producer;
  bool has_place = true, large = false;
  const auto keep = [&]<class One>(const One& one) REALTIME {
    if constexpr (kWaitsInside<One>) {
      std::memcpy(queued.small.data(), &one, sizeof one);
    } else {
      const std::uint16_t* const place = lane.free.front();
      large = true;
      has_place = place != nullptr;
      if (!has_place) return;
      queued.place = *place;
      std::memcpy(lane.large[*place].bytes.data(), &one, sizeof one);
    }
  };
  visit_now(keep, event.verb);
  if (!has_place || !lane.ring.push(queued)) return false;
  if (large) lane.free.pop();
  return true;
}

Event EventQueue::event_of(const QueuedEvent& queued) const REALTIME {
  Event event{.frame = queued.frame, .object = queued.object};
  const Lane& lane = lanes_[static_cast<std::size_t>(queued.producer)];
  const auto copy = [&]<class One>(const One& one) REALTIME {
    const void* from = &one;
    if constexpr (!kWaitsInside<One>) from = lane.large[queued.place].bytes.data();
    One made;
    std::memcpy(&made, from, sizeof made);
    event.verb = made;
  };
  visit_now(copy, Verbs(), queued.verb, queued.small.data());
  return event;
}

void EventQueue::release(const QueuedEvent& queued) REALTIME {
  const auto give_back = [&]<class One>(const One&) REALTIME {
    if constexpr (!kWaitsInside<One>) {
      static_cast<void>(lanes_[static_cast<std::size_t>(queued.producer)].free.push(queued.place));
    }
  };
  visit_now(give_back, Verbs(), queued.verb, queued.small.data());
}

// A binary heap by frame, and among events of one frame by the order in which they came. The audio thread moves events
// into it from the rings at each chunk; what finds it full stays in its ring, so nothing is lost.
bool EventQueue::wait(const QueuedEvent& queued, Frame now) REALTIME {
  Pending* const heap = heap_.data();
  heap[count_] = {queued, next_order_++, false};
  heap[count_].event.frame = std::max(queued.frame, now);
  ++count_;
  std::push_heap(heap, heap + count_, Later{});
  return queued.frame < now;
}

void EventQueue::rescale_pending(Frame now, double ratio) {
  const auto begin = heap_.begin(), end = begin + static_cast<std::ptrdiff_t>(count_);
  std::sort(begin, end, [](const Pending& a, const Pending& b) { return Later{}(b, a); });
  next_order_ = 0;  // two frames may become one; their events keep their order
  std::for_each(begin, end, [&](Pending& pending) {
    const double ahead = static_cast<double>(pending.event.frame - now) * ratio;
    pending.event.frame = now + static_cast<Frame>(std::llround(ahead));
    pending.order = next_order_++;
  });
}

void EventQueue::pop() REALTIME {
  std::pop_heap(heap_.data(), heap_.data() + count_, Later{});
  --count_;
}

void EventQueue::put_back(const Pending& pending) REALTIME {
  assert(count_ < heap_.size());
  heap_[count_++] = pending;
  std::push_heap(heap_.data(), heap_.data() + count_, Later{});
}

}  // namespace ringdown::synth
