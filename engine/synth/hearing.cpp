#include "engine/synth/hearing.h"

#include "engine/modal/masking.h"

#include <algorithm>
#include <cmath>

namespace ringdown::synth {
namespace {

constexpr double kBandsPerBark = 2;

std::size_t index_of(Level level) RINGDOWN_REALTIME {
  return static_cast<std::size_t>(std::clamp<Level>(level - Hearing::kLowest, 0, Hearing::kLevels - 1));
}

// Bark to Hz by halving: called once per band, on the worker.
double frequency_at(double bark) {
  double low = 1, high = 400000;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    (modal::bark(middle) < bark ? low : high) = middle;
  }
  return low;
}

}  // namespace

EarBand ear_band_of(double frequency_hz) {
  const double band = kBandsPerBark * modal::bark(frequency_hz);
  return static_cast<EarBand>(std::clamp(band, 0.0, static_cast<double>(kEarBands - 1)));
}

Hearing::Hearing() {
  forget();
  for (Level i = 0; i < kLevels; ++i) {
    energy_[static_cast<std::size_t>(i)] = std::pow(10.0, 0.1 * kStep_db * (i + kLowest + 1));
  }
  for (std::size_t b = 0; b < kEarBands; ++b) {
    centre_bark_[b] = (static_cast<double>(b) + 0.5) / kBandsPerBark;
    centre_hz_[b] = frequency_at(centre_bark_[b]);
  }
}

void Hearing::forget() RINGDOWN_REALTIME {
  for (auto& levels : count_) levels.fill(0);
  for (auto& levels : in_groups_) levels.fill(0);
  modes_ = 0;
}

void Hearing::note(EarBand band, Level level, std::uint32_t modes) RINGDOWN_REALTIME {
  count_[band][index_of(level)] += modes;
}

void Hearing::note_group(EarBand band, Level level, std::uint32_t modes) RINGDOWN_REALTIME {
  in_groups_[band][index_of(level)] += modes;
  modes_ += modes;
}

Hearing::Thresholds Hearing::hidden_below() const RINGDOWN_REALTIME {
  Thresholds below;
  below.fill(Cut::kNothing);
  for (std::size_t masker = 0; masker < kEarBands; ++masker) {
    Level loudest = kLevels - 1;
    while (loudest >= 0 && count_[masker][static_cast<std::size_t>(loudest)] == 0) --loudest;
    if (loudest < 0) continue;
    const double level_db = kStep_db * (loudest + kLowest) + kFullScale_db_spl;
    for (std::size_t b = 0; b < kEarBands; ++b) {
      const double hidden_db =
          modal::masked_below_db(level_db, centre_hz_[masker], centre_bark_[masker], centre_bark_[b]);
      below[b] = std::max(below[b], static_cast<Level>(std::floor((hidden_db - kFullScale_db_spl) / kStep_db)));
    }
  }
  return below;
}

Cut Hearing::decide(bool masking, Level least) const RINGDOWN_REALTIME {
  Cut cut;
  cut.hides = masking || least > Cut::kNothing;
  cut.at.fill(least);
  if (!masking) return cut;
  const Thresholds hidden = hidden_below();
  for (std::size_t b = 0; b < kEarBands; ++b) {
    if (hidden[b] <= kLowest) continue;
    const double most = energy_[static_cast<std::size_t>(std::min(hidden[b] - kLowest, kLevels) - 1)];
    double left_out = 0;
    Level level = kLowest;
    for (; level < kLowest + kLevels && level < hidden[b]; ++level) {
      const auto i = static_cast<std::size_t>(level - kLowest);
      left_out += count_[b][i] * energy_[i];
      if (left_out > most) break;
    }
    cut.at[b] = std::max(least, level);
  }
  return cut;
}

Level Hearing::least_for(double modes) const RINGDOWN_REALTIME {
  if (static_cast<double>(modes_) <= modes) return Cut::kNothing;
  const Cut cut = decide(true);
  std::array<std::uint64_t, kLevels> passing{};
  for (std::size_t b = 0; b < kEarBands; ++b) {
    for (Level level = std::max(cut.at[b], kLowest); level < kLowest + kLevels; ++level) {
      const auto i = static_cast<std::size_t>(level - kLowest);
      passing[i] += in_groups_[b][i];
    }
  }
  Level least = kLowest + kLevels;
  for (double left = modes; least > kLowest; --least) {
    left -= static_cast<double>(passing[static_cast<std::size_t>(least - 1 - kLowest)]);
    if (left < 0) break;
  }
  return least;
}

}  // namespace ringdown::synth
