#include "manual/completion.h"

namespace ringdown::manual {
namespace {

// Inside single quotes and the brackets of _arguments.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string action(const Option& option) {
  std::string words;
  for (const std::string& choice : option.choices()) words += (words.empty() ? "" : " ") + choice;
  return words.empty() ? (option.wants_file() ? "_files" : " ") : "(" + words + ")";
}

std::string argument(const Option& option) {
  if (option.by_place()) return "'*:" + escaped(option.names[0]) + ":_files'";
  std::string names = option.repeats ? "*" : "", exclusive, alternatives;
  for (const std::string& name : option.names) {
    exclusive += (exclusive.empty() ? "" : " ") + name;
    alternatives += (alternatives.empty() ? "" : ",") + name;
  }
  std::string what = "[" + escaped(option.sentence) + "]";
  if (!option.value.empty()) what += ":" + escaped(option.value) + ":" + action(option);
  if (option.names.size() == 1) return "'" + names + alternatives + what + "'";
  const std::string shut = option.repeats ? "'*'" : "'(" + exclusive + ")'";
  return shut + "{" + alternatives + "}'" + what + "'";
}

std::string arguments(const Command& command, const std::string& indent) {
  std::string text;
  for (const Option& option : command.options) text += " \\\n" + indent + argument(option);
  return text;
}

std::string verb_case(const Command& verb) {
  if (verb.passes_on) return "        " + verb.name + ") _files ;;\n";
  return "        " + verb.name + ") _arguments -s" + arguments(verb, "            ") + " ;;\n";
}

}  // namespace

std::string zsh_completion(const Command& command) {
  std::string text = "#compdef " + command.name + "\n# Written by `" + command.name + " --manual zsh`.\n\n";
  if (command.commands.empty()) return text + "_arguments -s" + arguments(command, "  ") + "\n";
  text += "local context state line\ntypeset -A opt_args\n_arguments -C" + arguments(command, "  ");
  text += " \\\n  '1:verb:->verb' '*::argument:->argument'\ncase $state in\n  verb)\n    local -a verbs=(";
  for (const Command& verb : command.commands) text += "\n      '" + verb.name + ":" + escaped(verb.sentence) + "'";
  text += ")\n    _describe verb verbs ;;\n  argument)\n    case $words[1] in\n";
  for (const Command& verb : command.commands) text += verb_case(verb);
  return text + "    esac ;;\nesac\n";
}

}  // namespace ringdown::manual
