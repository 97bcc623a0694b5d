// The options that a command line has, as words for another one. [main]
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace ringdown::cli {

// Those that were given and are not `except` (with their dashes), in the order that --help has them: {"--keep", "100",
// "--preview"}. Positional arguments are not among them. An option that a later program version adds is.
std::vector<std::string> given_options(const CLI::App& app, std::initializer_list<std::string_view> except);

}  // namespace ringdown::cli
