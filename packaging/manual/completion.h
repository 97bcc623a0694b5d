// Scripts that teach a shell to complete a program's command line: verbs, options, the values of those that have
// choices, and files elsewhere.
#pragma once

#include "packaging/manual/command.h"

#include <string>

namespace ringdown::manual {

std::string bash_completion(const Command& command);
std::string zsh_completion(const Command& command);
std::string fish_completion(const Command& command);

}  // namespace ringdown::manual
