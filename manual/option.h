// The option --manual man|bash|zsh|fish of every program: writes its man page or its completion script to the standard
// output, from the options it has by then, and ends the parsing with CLI::Success. --help does not list it: the build
// uses it, once per program and kind. [main]
#pragma once

#include "manual/man_page.h"

#include <vector>

namespace ringdown::manual {

// Call it last: it sees the options that `app` has when the command line is parsed.
void add_manual_option(CLI::App& app, std::vector<Section> sections);

}  // namespace ringdown::manual
