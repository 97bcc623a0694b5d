// The command line that all programs have in common: --version, --manual, the exit codes below --help, one sentence for
// a mistake, and checks of values that --help and the man page describe in words. [main]
//
//   CLI::App app("Does this and that.", "ringdown-thing");
//   manual::add_common_options(app);
//   app.add_option("--rate", rate, "Sample rate in Hz")->check(manual::between(8000.0, 768000.0));
//   if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
#pragma once

#include "packaging/manual/man_page.h"
#include "protocol/exit_codes.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <sstream>
#include <vector>

namespace ringdown::manual {

// Demands a number from `low` to `high`, both included.
template <class Number>
CLI::Validator between(Number low, Number high) {
  std::ostringstream words;
  words << "from " << low << " to " << high;
  return CLI::Range(low, high).description(words.str());
}

inline CLI::Validator above_zero() { return CLI::PositiveNumber.description("greater than 0"); }

// Adds --version and the list of exit codes below --help. Call it before the program's own options are added.
void add_common_options(CLI::App& app);

// Parses the command line. Returns the exit code of a program that has nothing left to do: after --help, --version or
// `--manual man|bash|zsh|fish`, which stands alone and writes the man page or a completion script to the standard
// output for the build, and after a mistake or, in a verb that ran while it was parsed, a lack of memory: then one
// sentence is on the standard error.
std::optional<protocol::ExitCode> parse(CLI::App& app, int argc, char** argv,
                                        const std::vector<Section>& sections = {});

// Says what is wrong with a command line that CLI11 accepted, and names the --help that lists the options.
protocol::ExitCode complain_of_usage(const CLI::App& app, const std::string& what);

}  // namespace ringdown::manual
