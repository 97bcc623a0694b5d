// The page of `ringdown compare`: one HTML file with its pictures in it. [any]
#pragma once

#include "clients/cli/fit/sound.h"
#include "engine/fit/comparison.h"
#include "engine/fit/modes.h"
#include "engine/fit/recorded_bank.h"
#include "engine/modal/bank.h"

#include <optional>
#include <string>
#include <vector>

namespace ringdown::cli {

struct ComparedSound {
  std::string name;
  Sound sound;
  fit::Fit found;
  std::vector<fit::Mode> baked;  // the bank's matching modes, as loud as in this recording
  double distance_db = 0;
};

struct Comparison {
  std::string name, material;
  std::vector<fit::Mode> heard;  // of all recordings
  modal::Bank bank;              // as it was baked, with the fitted Poisson's ratio
  fit::Calibration calibration;
  double poisson_ratio = 0, given_poisson_ratio = 0;
  bool nu_told = false;
  std::vector<ComparedSound> sounds;

  [[nodiscard]] double stiffness() const;   // E/rho over that of the material
  [[nodiscard]] double mean_cents() const;  // of the matches, after E/rho and nu
  [[nodiscard]] double worst_cents() const;
  [[nodiscard]] double decay_error() const;  // the mean factor by which decays are off that fit the damping, less 1
  // Of the energy of all modes heard: that of those that match, and of what is heard within kCompanion_cents of them.
  [[nodiscard]] double matched_part() const;
};

// The comparison's result in a few lines of text; the page shows the same at length.
std::string verdict(const Comparison& comparison);

std::string compare_page(const Comparison& comparison);

}  // namespace ringdown::cli
