// How the frequencies of one shape depend on Poisson's ratio. [worker]
//
//   const NuCurves curves(banks);                              // three quick bakes
//   const NuChoice choice = choose_nu(heard, curves, options); // comparison.h
//   const NuCurves better = curves.through(bank, nu);          // an exact bake at one ratio
//
// nu_curves.cpp describes how a mode is followed from bank to bank.
#pragma once

#include "engine/fit/identification.h"
#include "engine/modal/bank.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

struct NuBank {
  double poisson_ratio;
  const modal::Bank* bank;
};

class NuCurves {
 public:
  // `banks` are three banks of one shape with ascending ratios. Modes that one of them lacks have no curve.
  explicit NuCurves(std::span<const NuBank, 3> banks);

  [[nodiscard]] double lowest() const { return nu_.front(); }
  [[nodiscard]] double highest() const { return nu_.back(); }

  // The frequencies at a ratio, ascending [Hz].
  [[nodiscard]] std::vector<double> at(double nu) const;

  // Returns curves that meet the frequencies of `exact`, a bank at the ratio `nu`: each is multiplied by one factor.
  // Modes that `exact` lacks are left out.
  [[nodiscard]] NuCurves through(const modal::Bank& exact, double nu) const;

  // The frequencies at a ratio, and d ln f / d nu of each.
  [[nodiscard]] Slopes slopes(double nu) const;

 private:
  // The modes of a bank by frequency.
  struct Modes {
    std::vector<double> frequency_hz;
    std::vector<modal::Vec3f> positions;
    std::vector<modal::Vec3f> shapes;  // M x P, mode-major; empty: unknown

    explicit Modes(const modal::Bank& bank);
  };

  [[nodiscard]] std::vector<double> in_order(double nu) const;
  static std::vector<std::size_t> partners(const Modes& of, const Modes& among);
  void keep(const std::vector<std::size_t>& curves);

  std::array<double, 3> nu_{};
  std::array<std::vector<double>, 3> frequencies_;  // of each curve, at each ratio
  Modes middle_;                                    // each curve's mode in the middle bank
};

}  // namespace ringdown::fit
