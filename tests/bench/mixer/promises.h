// What the mixer benchmark promises.
#pragma once

#include "tests/bench/mixer/row.h"
#include "tests/bench/promise.h"

namespace ringdown::bench {

std::vector<Promise> promises(const Rows& rows);

}  // namespace ringdown::bench
