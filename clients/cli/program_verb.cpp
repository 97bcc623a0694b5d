#include "clients/cli/verb.h"

#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unistd.h>

namespace ringdown::cli {
namespace {

// Becomes the program of that name that lies beside this one. Returns only when that fails.
ExitCode become(const std::string& name, std::vector<std::string> arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / name).string();
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  return complain("cannot run " + program + ": " + std::strerror(errno) + "; it is a program of its own, build or " +
                      "install it beside ringdown",
                  ExitCode::failure);
}

}  // namespace

void add_program_verb(CLI::App& app, ExitCode& outcome, const std::string& name, const std::string& sentence) {
  CLI::App* verb = app.add_subcommand(name, sentence + " See ringdown " + name + " --help.");
  verb->set_help_flag();  // --help, too, is for the other program
  verb->prefix_command();
  verb->callback([verb, name, &outcome] { outcome = become("ringdown-" + name, verb->remaining()); });
}

}  // namespace ringdown::cli
