#include "manual/completion.h"

namespace ringdown::manual {
namespace {

std::string function_name(std::string program) {
  for (char& c : program) {
    if (c == '-') c = '_';
  }
  return "_" + program;
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

// The rows of `case "$verb $before"`: what may follow an option.
std::string value_cases(const Command& command, const std::string& verb) {
  std::string text;
  for (const Option& option : command.options) {
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

std::string option_words(const Command& command) {
  std::vector<std::string> words;
  for (const Option& option : command.options) {
    if (!option.by_place()) words.insert(words.end(), option.names.begin(), option.names.end());
  }
  return joined(words, " ");
}

constexpr const char* kHead = R"(
_ringdown_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_ringdown_files() { compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$word"); }

)";

// Bash makes a word of its own of the = in --option=value.
constexpr const char* kWords = R"(() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb= i
  COMPREPLY=()
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
)";

}  // namespace

std::string bash_completion(const Command& command) {
  std::vector<std::string> verbs;
  for (const Command& verb : command.commands) verbs.push_back(verb.name);
  std::string text = "# Written by `" + command.name + " --manual bash`.\n" + kHead;
  text += function_name(command.name) + kWords;
  if (!verbs.empty()) {
    text += "  for ((i = 1; i < COMP_CWORD; ++i)); do\n    case ${COMP_WORDS[i]} in\n      " + joined(verbs, " | ") +
            ") verb=${COMP_WORDS[i]}; break ;;\n    esac\n  done\n";
  }
  text += "  case \"$verb $before\" in\n" + value_cases(command, "");
  for (const Command& verb : command.commands) text += value_cases(verb, verb.name);
  text += "  esac\n  case \"$verb:$word\" in\n    :-*) _ringdown_words '" + option_words(command) + "' ;;\n";
  for (const Command& verb : command.commands) {
    text += "    " + verb.name + ":-*) _ringdown_words '" + option_words(verb) + "' ;;\n";
  }
  if (!verbs.empty()) text += "    :*) _ringdown_words '" + joined(verbs, " ") + "' ;;\n";
  text +=
      "    *) _ringdown_files ;;\n  esac\n}\ncomplete -F " + function_name(command.name) + " " + command.name + "\n";
  return text;
}

}  // namespace ringdown::manual
