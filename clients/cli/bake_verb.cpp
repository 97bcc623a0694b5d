#include "clients/cli/verb.h"

#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unistd.h>

namespace ringdown::cli {
namespace {

// Becomes the program ringdown-bake that lies beside this one. Returns only when that fails.
ExitCode become_bake(std::vector<std::string> arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "ringdown-bake").string();
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  return complain("cannot run " + program + ": " + std::strerror(errno) +
                      "; baking is a program of its own, build or install ringdown-bake beside ringdown",
                  ExitCode::failure);
}

}  // namespace

void add_bake_verb(CLI::App& app, ExitCode& outcome) {
  CLI::App* verb = app.add_subcommand("bake", "Turns a mesh and a material into a bank; see ringdown bake --help.");
  verb->set_help_flag();  // --help, too, is for the other program
  verb->prefix_command();
  verb->callback([verb, &outcome] { outcome = become_bake(verb->remaining()); });
}

}  // namespace ringdown::cli
