// A table of the stress suite: lines are printed as they come, and written as Markdown to the file that
// $RINGDOWN_STRESS_TABLE names when the program ends. One table for each program.
#pragma once

#include <string>

namespace ringdown::test {

// The long form runs with RINGDOWN_STRESS=long.
bool long_form();

// `line` is a row in Markdown; `head` the two lines above the first one.
void enter_line(const std::string& head, const std::string& line);

}  // namespace ringdown::test
