// The page of `ringdown compare`: one HTML file with its pictures in it. [any]
#pragma once

#include "clients/cli/fit/baker.h"
#include "clients/cli/fit/sound.h"
#include "engine/fit/comparison.h"
#include "engine/fit/identification.h"
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
  std::vector<fit::Mode> baked;  // the bank's matching modes, with their levels in this recording
  double distance_db = 0;
};

struct Comparison {
  std::string name, material;
  std::vector<fit::Mode> heard;  // modes heard in all recordings
  modal::Bank bank;              // unscaled, with the fitted Poisson's ratio
  fit::Calibration calibration;
  double poisson_ratio = 0, given_poisson_ratio = 0;
  bool nu_told = false;
  std::vector<Figure> figures;                // that were fitted besides E/rho
  fit::Slopes slopes;                         // how each of them moves the bank's frequencies
  std::vector<double> volume_slopes;          // d ln volume / d figure, of each
  std::optional<fit::Determined> determined;  // errors of E/rho and of these figures
  double weight_kg = 0;                       // 0: not known
  bool decays_known = true;                   // false: a list of frequencies alone
  std::optional<fit::Chance> chance;          // where nu was searched
  std::vector<ComparedSound> sounds;

  [[nodiscard]] double stiffness() const;   // fitted E/rho over that of the material
  [[nodiscard]] double mean_cents() const;  // mean deviation of the matches, after fitting E/rho and nu
  [[nodiscard]] double worst_cents() const;
  [[nodiscard]] double decay_error() const;  // mean factor between measured decays and the fitted damping, less 1
  // Returns the share of the energy of all heard modes that belongs to matching modes and to modes heard within
  // kCompanion_cents of these.
  [[nodiscard]] double matched_part() const;
};

// Returns the comparison's result in a few lines of text; the page shows it in detail.
std::string verdict(const Comparison& comparison);

std::string compare_page(const Comparison& comparison);

}  // namespace ringdown::cli
