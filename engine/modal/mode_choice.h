// Takes some of a bank's modes, in another order. [worker]
#pragma once

#include "engine/modal/bank.h"

#include <cstddef>
#include <vector>

namespace ringdown::modal {

// Leaves the modes of these numbers, in this order, with all that the bank holds of each. Numbers are below
// mode_count(); one may come twice.
void take_modes(Bank& bank, const std::vector<std::size_t>& order);

}  // namespace ringdown::modal
