// The table of the mixer's stress suite (table_file.h): one line for each case.
#pragma once

#include "tests/stress/table_file.h"

#include <string>

namespace ringdown::synth::test {

using ringdown::test::long_form;

struct MixerLine {
  std::string name;     // the case
  std::string hard;     // what is hard about it
  std::string figure;   // what was measured
  std::string allowed;  // what the test allows
};

void enter(const MixerLine& line);

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

}  // namespace ringdown::synth::test
