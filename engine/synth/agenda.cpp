#include "engine/synth/agenda.h"

#include <algorithm>

namespace ringdown::synth {

std::size_t Agenda::accept(protocol::Frame now) RINGDOWN_REALTIME {
  Pending* const heap = heap_.data();
  std::size_t late = 0;
  for (Ring& ring : rings_) {
    for (; count_ < kMostPendingEvents; ring.pop()) {
      const protocol::Event* event = ring.front();
      if (!event) break;
      heap[count_] = {*event, next_order_++};
      if (event->frame < now) {
        heap[count_].event.frame = now;
        ++late;
      }
      ++count_;
      std::push_heap(heap, heap + count_, Later{});
    }
  }
  return late;
}

void Agenda::pop() RINGDOWN_REALTIME {
  std::pop_heap(heap_.data(), heap_.data() + count_, Later{});
  --count_;
}

}  // namespace ringdown::synth
