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

// Checks of numbers. Every option that takes a number has one of them: each refuses a text that is not a number, and a
// number that is not finite. What they demand beyond that stands in --help.
CLI::Validator any_number();
CLI::Validator any_vector();  // three numbers with commas between them, as one text
CLI::Validator above_zero();

// Returns what is wrong with `text` as a number from `low` to `high`, or nothing. [any]
std::string wrong_number(const std::string& text, double low, double high, const std::string& demand);

// Demands a number from `low` to `high`, both included.
template <class Number>
CLI::Validator between(Number low, Number high) {
  std::ostringstream words;
  words << "from " << low << " to " << high;
  const auto check = [low, high, demand = " " + words.str()](const std::string& text) {
    return wrong_number(text, static_cast<double>(low), static_cast<double>(high), demand);
  };
  return CLI::Validator(check, words.str());
}

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
