// The mixer's part of the stress suite's table: printed as it goes, and written as Markdown to the file that
// $RINGDOWN_STRESS_TABLE names.
#pragma once

#include <string>

namespace ringdown::synth::test {

// The long form runs with RINGDOWN_STRESS=long.
bool long_form();

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
