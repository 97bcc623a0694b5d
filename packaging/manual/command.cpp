#include "packaging/manual/command.h"

#include <CLI/CLI.hpp>

#include <sstream>

namespace ringdown::manual {
namespace {

std::string without_full_stop(std::string text) {
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// CLI11 appends what the option's check demands to the name of the value's type, after a colon.
void read_value(CLI::Option& option, Option& row) {
  row.value = option.get_type_name();
  try {
    row.accepted = option.get_validator(0)->get_description();
  } catch (const CLI::OptionNotFound&) {
    return;  // nothing is checked
  }
  if (!row.accepted.empty()) row.value.resize(row.value.size() - row.accepted.size() - 1);
}

Option row_of(CLI::Option& option) {
  Option row;
  for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  if (row.names.empty()) row.names.push_back(option.get_name());
  if (option.get_expected_max() > 0) read_value(option, row);
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

Command command_of(CLI::App& app) {
  Command command{.name = app.get_name(), .sentence = without_full_stop(app.get_description())};
  command.passes_on = app.get_prefix_command();
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) command.options.push_back(row_of(*option));
  }
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) {
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
