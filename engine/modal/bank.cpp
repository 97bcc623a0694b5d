#include "engine/modal/bank.h"

#include <algorithm>

namespace ringdown::modal {

std::optional<ErrorSpread> error_spread(const Bank& bank) {
  if (bank.frequency_error.empty()) return std::nullopt;
  std::vector<double> errors = bank.frequency_error;
  std::sort(errors.begin(), errors.end());
  return ErrorSpread{.median = errors[errors.size() / 2], .largest = errors.back()};
}

}  // namespace ringdown::modal
