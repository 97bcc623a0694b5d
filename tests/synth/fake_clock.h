// Time that passes only by work: what the tests of the time budget measure with.
#pragma once

#include "engine/synth/objects/time_budget.h"

#include <cstdint>
#include <utility>

namespace ringdown::synth::test {

inline std::int64_t fake_now_ns = 0;
inline double fake_unit_ns = 0;
inline std::int64_t fake_stall_ns = 0;  // once
inline std::int64_t fake_read_ns = 0;   // each time the clock is read
inline std::int64_t fake_clock() REALTIME { return fake_now_ns += fake_read_ns; }
inline void fake_work(double units) REALTIME {
  fake_now_ns += static_cast<std::int64_t>(units * fake_unit_ns) + std::exchange(fake_stall_ns, 0);
}
inline constexpr WorkClock kFake{fake_clock, fake_work};

}  // namespace ringdown::synth::test
