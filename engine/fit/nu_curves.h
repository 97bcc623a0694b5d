// How the frequencies of one shape depend on Poisson's ratio. [worker]
//
//   const NuCurves curves(banks);                              // three quick bakes, or more
//   const NuChoice choice = choose_nu(heard, curves, options); // comparison.h
//   const NuCurves better = curves.through(bank, nu);          // an exact bake at one ratio
//
// nu_curves.cpp describes how a mode is followed from bank to bank.
#pragma once

#include "engine/fit/identification.h"
#include "engine/modal/bank.h"

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
  // `banks` are three or more banks of one shape with ascending ratios. Modes that one of them lacks have no curve.
  explicit NuCurves(std::span<const NuBank> banks);

  // The range of ratios that a search takes: that of the banks, or less.
  [[nodiscard]] double lowest() const { return lowest_; }
  [[nodiscard]] double highest() const { return highest_; }

  // Returns these curves with a narrower range: the search then takes the ratios up to `aside` from `nu`.
  [[nodiscard]] NuCurves around(double nu, double aside) const;

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

  double lowest_, highest_;
  std::vector<double> nu_;                        // of each bank
  std::vector<std::vector<double>> frequencies_;  // of each curve, at each ratio
  Modes middle_;                                  // each curve's mode in the middle bank
};

}  // namespace ringdown::fit
