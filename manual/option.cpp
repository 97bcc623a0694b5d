#include "manual/option.h"

#include "manual/completion.h"

#include <CLI/CLI.hpp>

#include <cstdio>

namespace ringdown::manual {
namespace {

std::string text_of(const std::string& kind, const Command& command, const std::vector<Section>& sections) {
  if (kind == "man") return man_page(command, sections);
  if (kind == "bash") return bash_completion(command);
  if (kind == "zsh") return zsh_completion(command);
  return fish_completion(command);
}

}  // namespace

void add_manual_option(CLI::App& app, std::vector<Section> sections) {
  const auto write = [&app, sections = std::move(sections)](const std::string& kind) {
    const std::string text = text_of(kind, command_of(app), sections);
    if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
      throw CLI::RuntimeError("cannot write to the standard output", 1);
    }
    throw CLI::Success();
  };
  app.add_option_function<std::string>("--manual", write)
      ->check(CLI::IsMember({"man", "bash", "zsh", "fish"}))
      ->configurable(false)
      ->group("");
}

}  // namespace ringdown::manual
