// Tells how a bank was made, for programs that read JSON. [any]
#pragma once

#include "engine/modal/bank.h"

#include <string>

namespace ringdown::modal {

// Returns a JSON object with the keys of extras.ringdown that say how the bank was made
// (docs/reference/bank-format.md), and `generator`, `held`, `air` and `doubtful`. Defined in bank_extras.cpp.
std::string provenance_text(const Bank& bank);

}  // namespace ringdown::modal
