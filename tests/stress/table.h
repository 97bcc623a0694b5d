// The table of the stress suite of bakes (table_file.h): one line for each case.
#pragma once

#include "tests/stress/table_file.h"

#include <Eigen/Core>

#include <limits>
#include <string>

namespace ringdown::test {

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
