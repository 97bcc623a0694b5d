#include "tests/bench/mixer/timing.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>
#include <malloc.h>

namespace ringdown::bench {
namespace {

double clock_s(clockid_t which) {
  timespec time{};
  ::clock_gettime(which, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_s() { return clock_s(CLOCK_MONOTONIC); }
double processor_s() { return clock_s(CLOCK_THREAD_CPUTIME_ID); }

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return kNone;
  const auto place = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

// One reading of the clock per block: its end is the start of the next.
template <class Enough>
void time_until(const std::function<void()>& render, const Enough& enough, BlockTimes& times) {
  const double processor_start = processor_s(), start = wall_s();
  double last = start;
  std::size_t blocks = 0;
  while (!enough(blocks, last - start)) {
    render();
    const double now = wall_s();
    times.blocks_s.push_back(now - last);
    last = now;
    ++blocks;
  }
  times.repeats_s.push_back((processor_s() - processor_start) / static_cast<double>(blocks));
}

}  // namespace

void time_repeat(const std::function<void()>& render, double seconds, BlockTimes& times) {
  render();
  time_until(
      render, [seconds](std::size_t blocks, double spent_s) { return blocks >= 3 && spent_s >= seconds; }, times);
}

void time_blocks(const std::function<void()>& render, std::size_t count, BlockTimes& times) {
  time_until(
      render, [count](std::size_t blocks, double) { return blocks == count; }, times);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

void fill_in(Row& row, const BlockTimes& times) {
  const double mean_s = median(times.repeats_s);
  row.mean_us = 1e6 * mean_s;
  row.p50_us = 1e6 * quantile(times.blocks_s, 0.5);
  row.p99_us = 1e6 * quantile(times.blocks_s, 0.99);
  row.max_us = 1e6 * quantile(times.blocks_s, 1);
  if (row.modes > 0) row.modes_per_core = static_cast<double>(row.modes * row.block) / kRate / mean_s;
}

double heap_bytes() {
  const struct mallinfo2 info = ::mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

}  // namespace ringdown::bench
