#include "packaging/manual/man_page.h"

#include "engine/base/version.h"
#include "protocol/exit_codes.h"

#include <algorithm>
#include <cctype>

namespace ringdown::manual {
namespace {

// Escapes a text so that roff shows it unchanged: minus signs that can be copied, no line that looks like a request.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  if (out.starts_with('.') || out.starts_with('\'')) out.insert(0, "\\&");
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + plain(text) + "\\fR"; }

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string sentence_of(const OptionRow& option) {
  std::string text = option.sentence;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  if (!option.accepted.empty()) text += "; " + option.accepted;
  if (!option.fallback.empty()) text += "; " + option.fallback + " if left out";
  if (option.required) text += "; required";
  return text + ".";
}

std::string entry_of(const OptionRow& option) {
  std::string term;
  for (const std::string& name : option.names) {
    if (!term.empty()) term += ", ";
    term += option.by_place() ? italic(name) : bold(name);
  }
  if (!option.value.empty() && !option.by_place()) term += " " + italic(option.value);
  return ".TP\n" + term + "\n" + plain(sentence_of(option)) + "\n";
}

std::string options_of(const Command& command) {
  std::string text;
  for (const OptionRow& option : command.options) text += entry_of(option);
  return text;
}

std::string synopsis(const Command& command) {
  std::string line = bold(command.name);
  if (!command.options.empty()) line += " [" + italic("OPTION") + "]...";
  for (const OptionRow& option : command.options) {
    if (option.by_place())
      line += option.required ? " " + italic(option.names[0]) : " [" + italic(option.names[0]) + "]";
  }
  if (!command.commands.empty()) line += " " + italic("VERB") + " [" + italic("ARGUMENT") + "]...";
  return line + "\n";
}

std::string verb_of(const Command& verb) {
  return ".SS " + synopsis(verb) + plain(verb.sentence) + ".\n" + options_of(verb);
}

std::string exit_status() {
  std::string text = ".SH EXIT STATUS\n";
  for (const protocol::ExitMeaning& exit : protocol::kExitMeanings) {
    text +=
        ".TP\n" + bold(std::to_string(static_cast<int>(exit.code))) + "\n" + plain(std::string(exit.meaning)) + "\n";
  }
  return text;
}

}  // namespace

std::string man_page(const Command& command, const std::vector<Section>& sections) {
  std::string page = ".\\\" Written by `" + command.name + " --manual man`.\n";
  page += ".TH " + upper(plain(command.name)) + " 1 \"\" \"Ringdown " + kVersion + "\" \"Ringdown\"\n";
  page += ".SH NAME\n" + plain(command.name) + " \\- " + plain(command.sentence) + "\n";
  page += ".SH SYNOPSIS\n" + synopsis(command);
  page += ".SH OPTIONS\n" + options_of(command);
  if (!command.commands.empty()) page += ".SH VERBS\n";
  for (const Command& verb : command.commands) page += verb_of(verb);
  for (const Section& section : sections) {
    page += ".SH " + section.heading + "\n";
    for (const auto& [term, text] : section.entries) page += ".TP\n" + bold(term) + "\n" + plain(text) + "\n";
  }
  return page + exit_status();
}

}  // namespace ringdown::manual
