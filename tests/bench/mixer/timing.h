// Times of blocks. Wall time of each, for its spread; processor time of many, which other programs do not disturb, for
// throughput.
#pragma once

#include "tests/bench/mixer/row.h"

#include <functional>
#include <vector>

namespace ringdown::bench {

struct BlockTimes {
  std::vector<double> blocks_s;   // wall time of each block
  std::vector<double> repeats_s;  // processor time per block, one for each repeat
};

// Renders blocks for about `seconds`, at least three, after one that is not timed.
void time_repeat(const std::function<void()>& render, double seconds, BlockTimes& times);

// Renders `blocks` blocks, all of them timed.
void time_blocks(const std::function<void()>& render, std::size_t blocks, BlockTimes& times);

double median(std::vector<double> values);  // kNone of none

// mean_us, p50_us, p99_us, max_us; with `modes` and `block` also modes_per_core.
void fill_in(Row& row, const BlockTimes& times);

// Bytes that this process holds from malloc and operator new.
double heap_bytes();

}  // namespace ringdown::bench
