// Selects and reorders modes of a bank. [worker]
#pragma once

#include "engine/modal/bank.h"

#include <cstddef>
#include <vector>

namespace ringdown::modal {

// Keeps only the modes of these numbers, in this order, with all their data. Numbers are below mode_count(); a number
// may occur twice.
void take_modes(Bank& bank, const std::vector<std::size_t>& order);

}  // namespace ringdown::modal
