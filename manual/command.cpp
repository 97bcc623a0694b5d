#include "manual/command.h"

#include <CLI/CLI.hpp>

#include <regex>
#include <sstream>

namespace ringdown::manual {
namespace {

std::string without_full_stop(std::string text) {
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// CLI11 writes "FLOAT:FLOAT in [8000 - 768000]" and "FLOAT:POSITIVE".
void read_value(const std::string& type, Option& row) {
  static const std::regex kRange(R"((.*):\w+ in \[(.*) - (.*)\])");
  static const std::regex kPositive("(.*):POSITIVE");
  std::smatch part;
  row.value = type;
  if (std::regex_match(type, part, kRange)) {
    row.value = part[1];
    row.accepted = "from " + part[2].str() + " to " + part[3].str();
  } else if (std::regex_match(type, part, kPositive)) {
    row.value = part[1];
    row.accepted = "greater than 0";
  }
}

Option row_of(const CLI::Option& option) {
  Option row;
  for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  if (row.names.empty()) row.names.push_back(option.get_name());
  if (option.get_expected_max() > 0) read_value(option.get_type_name(), row);
  row.fallback = option.get_default_str();
  row.sentence = without_full_stop(option.get_description());
  row.required = option.get_required();
  row.repeats = option.get_items_expected_max() > 2;
  return row;
}

}  // namespace

std::vector<std::string> Option::choices() const {
  std::vector<std::string> all;
  if (value.find('|') == value.npos) return all;
  std::istringstream words(value);
  for (std::string word; std::getline(words, word, '|');) all.push_back(word);
  return all;
}

bool Option::wants_file() const { return value == "FILE" || value == "FOLDER"; }

Command command_of(const CLI::App& app) {
  Command command{.name = app.get_name(), .sentence = without_full_stop(app.get_description())};
  command.passes_on = app.get_prefix_command();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) command.options.push_back(row_of(*option));
  }
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    Command inner = command_of(*verb);
    if (!inner.name.empty()) {
      command.commands.push_back(std::move(inner));
    } else {  // a group of options, not a verb; it has its own --help again
      for (Option& option : inner.options) {
        if (option.names.back() != "--help") command.options.push_back(std::move(option));
      }
    }
  }
  return command;
}

}  // namespace ringdown::manual
