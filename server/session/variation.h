// Varies the blows of a performance as a performer would: each at a slightly other point, for a slightly other time,
// and lasting contacts over other places of a rough surface. [any thread]
//
//   const Variation take({.seed = 3});
//   Session session(48000, {}, take);       // every event that is pushed
//
// An event is varied by what it is and by its frame, and not by what came before: two renderings with one seed are
// equal, whatever the size of their blocks.
#pragma once

#include "engine/synth/events/event.h"

#include <cstdint>

namespace ringdown::session {

struct VariationRange {
  std::uint64_t seed = 1;
  double point_m = 0.001;     // radius of the ball in which a strike's point lies about the one described
  double contact_time = 0.1;  // largest relative change of a strike's contact time
  double impulse = 0;         // largest relative change of a strike's impulse
};

class Variation {
 public:
  explicit Variation(const VariationRange& range) : range_(range) {}

  void operator()(synth::Event& event) const;

 private:
  VariationRange range_;
};

}  // namespace ringdown::session
