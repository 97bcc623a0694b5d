// The table of the stress suite: one line for each case, printed as it goes, and written as Markdown to the file that
// $RINGDOWN_STRESS_TABLE names.
#pragma once

#include <Eigen/Core>

#include <limits>
#include <string>

namespace ringdown::test {

// The long form runs with RINGDOWN_STRESS=long.
bool long_form();

inline constexpr double kNotSaid = std::numeric_limits<double>::quiet_NaN();

struct TableLine {
  std::string name;            // the case
  std::string hard;            // what is hard about it
  Eigen::Index unknowns = 0;   // 0: nothing was solved
  int found = 0, there = 0;    // modes in the band: in the bank, and by the truth
  double error = kNotSaid;     // the worst of them, relative
  double limit = kNotSaid;     // that the case allows
  double estimate = kNotSaid;  // the largest that the bank itself states
  double seconds = kNotSaid;   // of the bake, as it happened: no test depends on it
  std::string outcome;         // what the truth is, or what was repaired, or the sentence of the refusal
};

void enter(const TableLine& line);

}  // namespace ringdown::test
