#include "engine/modal/hearing/masking.h"

#include <algorithm>
#include <cmath>

namespace ringdown::modal {

// Zwicker & Terhardt, J. Acoust. Soc. Am. 68, 1980: critical-band rate in Bark from frequency in Hz.
double bark(double frequency_hz) {
  return 13 * std::atan(0.00076 * frequency_hz) + 3.5 * std::atan(std::pow(frequency_hz / 7500, 2));
}

double masked_below_db(double level_db, double frequency_hz, double bark_masker, double bark_masked) REALTIME {
  const double distance = bark_masked - bark_masker;
  const double slope = distance < 0 ? 27 : 24 + 230 / frequency_hz - 0.2 * level_db;
  return level_db - std::max(kMinMaskingOffset_db, 14.5 + bark_masker) - slope * std::abs(distance);
}

}  // namespace ringdown::modal
