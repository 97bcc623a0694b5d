#include "manual/completion.h"

namespace ringdown::manual {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string row(const std::string& program, const Option& option, const std::string& condition) {
  std::string text = "complete -c " + program + condition;
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.value.empty()) text += option.wants_file() ? " -r" : " -x";
  std::string words;
  for (const std::string& choice : option.choices()) words += (words.empty() ? "" : " ") + choice;
  if (!words.empty()) text += " -a " + quoted(words);
  return text + " -d " + quoted(option.sentence) + "\n";
}

std::string rows(const std::string& program, const Command& command, const std::string& condition) {
  std::string text;
  for (const Option& option : command.options) {
    if (!option.by_place()) text += row(program, option, condition);
  }
  return text;
}

}  // namespace

std::string fish_completion(const Command& command) {
  std::string text = "# Written by `" + command.name + " --manual fish`.\n";
  if (command.commands.empty()) return text + rows(command.name, command, "");
  text += rows(command.name, command, " -n __fish_use_subcommand");
  for (const Command& verb : command.commands) {
    text += "complete -c " + command.name + " -f -n __fish_use_subcommand -a " + verb.name + " -d " +
            quoted(verb.sentence) + "\n";
    text += rows(command.name, verb, " -n '__fish_seen_subcommand_from " + verb.name + "'");
  }
  return text;
}

}  // namespace ringdown::manual
