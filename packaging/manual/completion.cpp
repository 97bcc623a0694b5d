#include "packaging/manual/completion.h"

namespace ringdown::manual {
namespace {

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::string function_name(std::string program) {
  for (char& c : program) {
    if (c == '-') c = '_';
  }
  return "_" + program;
}

// The rows of `case "$verb $before"`: what may follow an option.
std::string bash_value_cases(const Command& command, const std::string& verb) {
  std::string text;
  for (const OptionRow& option : command.options) {
    if (option.by_place() || option.value.empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names) patterns.push_back("'" + verb + " " + name + "'");
    text += "    " + joined(patterns, " | ") + ") ";
    if (const auto choices = option.choices(); !choices.empty()) {
      text += "_ringdown_words '" + joined(choices, " ") + "'; return ;;\n";
    } else {
      text += option.wants_file() ? "_ringdown_files; return ;;\n" : "return ;;\n";
    }
  }
  return text;
}

std::string bash_option_words(const Command& command) {
  std::vector<std::string> words;
  for (const OptionRow& option : command.options) {
    if (!option.by_place()) words.insert(words.end(), option.names.begin(), option.names.end());
  }
  return joined(words, " ");
}

constexpr const char* kBashHelpers = R"(
_ringdown_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_ringdown_files() { compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$word"); }

)";

// In --option=value, bash makes the = a word of its own.
constexpr const char* kBashWords = R"(() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb= i
  COMPREPLY=()
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
)";

// Escapes a text that stands inside single quotes and the brackets of _arguments.
std::string zsh_quoted(const std::string& text) {
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

std::string zsh_action(const OptionRow& option) {
  const std::string words = joined(option.choices(), " ");
  return words.empty() ? (option.wants_file() ? "_files" : " ") : "(" + words + ")";
}

std::string zsh_argument(const OptionRow& option) {
  if (option.by_place()) return "'*:" + zsh_quoted(option.names[0]) + ":_files'";
  const std::string exclusive = joined(option.names, " "), alternatives = joined(option.names, ",");
  std::string what = "[" + zsh_quoted(option.sentence) + "]";
  if (!option.value.empty()) what += ":" + zsh_quoted(option.value) + ":" + zsh_action(option);
  if (option.names.size() == 1) return "'" + std::string(option.repeats ? "*" : "") + exclusive + what + "'";
  const std::string shut = option.repeats ? "'*'" : "'(" + exclusive + ")'";
  return shut + "{" + alternatives + "}'" + what + "'";
}

std::string zsh_arguments(const Command& command, const std::string& indent) {
  std::string text;
  for (const OptionRow& option : command.options) text += " \\\n" + indent + zsh_argument(option);
  return text;
}

std::string zsh_verb_case(const Command& verb) {
  if (verb.passes_on) return "        " + verb.name + ") _files ;;\n";
  return "        " + verb.name + ") _arguments -s" + zsh_arguments(verb, "            ") + " ;;\n";
}

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string fish_row(const std::string& program, const OptionRow& option, const std::string& condition) {
  std::string text = "complete -c " + program + condition;
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.value.empty()) text += option.wants_file() ? " -r" : " -x";
  const std::string words = joined(option.choices(), " ");
  if (!words.empty()) text += " -a " + fish_quoted(words);
  return text + " -d " + fish_quoted(option.sentence) + "\n";
}

std::string fish_rows(const std::string& program, const Command& command, const std::string& condition) {
  std::string text;
  for (const OptionRow& option : command.options) {
    if (!option.by_place()) text += fish_row(program, option, condition);
  }
  return text;
}

}  // namespace

std::string bash_completion(const Command& command) {
  std::vector<std::string> verbs;
  for (const Command& verb : command.commands) verbs.push_back(verb.name);
  std::string text = "# Written by `" + command.name + " --manual bash`.\n" + kBashHelpers;
  text += function_name(command.name) + kBashWords;
  if (!verbs.empty()) {
    text += "  for ((i = 1; i < COMP_CWORD; ++i)); do\n    case ${COMP_WORDS[i]} in\n      " + joined(verbs, " | ") +
            ") verb=${COMP_WORDS[i]}; break ;;\n    esac\n  done\n";
  }
  text += "  case \"$verb $before\" in\n" + bash_value_cases(command, "");
  for (const Command& verb : command.commands) text += bash_value_cases(verb, verb.name);
  text += "  esac\n  case \"$verb:$word\" in\n    :-*) _ringdown_words '" + bash_option_words(command) + "' ;;\n";
  for (const Command& verb : command.commands) {
    text += "    " + verb.name + ":-*) _ringdown_words '" + bash_option_words(verb) + "' ;;\n";
  }
  if (!verbs.empty()) text += "    :*) _ringdown_words '" + joined(verbs, " ") + "' ;;\n";
  text +=
      "    *) _ringdown_files ;;\n  esac\n}\ncomplete -F " + function_name(command.name) + " " + command.name + "\n";
  return text;
}

std::string zsh_completion(const Command& command) {
  std::string text = "#compdef " + command.name + "\n# Written by `" + command.name + " --manual zsh`.\n\n";
  if (command.commands.empty()) return text + "_arguments -s" + zsh_arguments(command, "  ") + "\n";
  text += "local context state line\ntypeset -A opt_args\n_arguments -C" + zsh_arguments(command, "  ");
  text += " \\\n  '1:verb:->verb' '*::argument:->argument'\ncase $state in\n  verb)\n    local -a verbs=(";
  for (const Command& verb : command.commands) text += "\n      '" + verb.name + ":" + zsh_quoted(verb.sentence) + "'";
  text += ")\n    _describe verb verbs ;;\n  argument)\n    case $words[1] in\n";
  for (const Command& verb : command.commands) text += zsh_verb_case(verb);
  return text + "    esac ;;\nesac\n";
}

std::string fish_completion(const Command& command) {
  std::string text = "# Written by `" + command.name + " --manual fish`.\n";
  if (command.commands.empty()) return text + fish_rows(command.name, command, "");
  text += fish_rows(command.name, command, " -n __fish_use_subcommand");
  for (const Command& verb : command.commands) {
    text += "complete -c " + command.name + " -f -n __fish_use_subcommand -a " + verb.name + " -d " +
            fish_quoted(verb.sentence) + "\n";
    text += fish_rows(command.name, verb, " -n '__fish_seen_subcommand_from " + verb.name + "'");
  }
  return text;
}

}  // namespace ringdown::manual
