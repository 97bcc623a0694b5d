// Every object of a folder to its bank: what changed only, each in a process of its own. [worker]
//
// The parent starts `ringdown-bake INPUT -o OUTPUT ...`, some at a time, and reads their progress from a pipe; it bakes
// nothing itself, so that a mesh that crashes gmsh, or needs all the memory, costs its own bank only. A bank that
// carries the hash of these very inputs (engine/bake/input_hash.h) and is whole is left alone. Children end when the
// parent does, however that ends; banks that are done stay, so that the same command goes on where it was.
#pragma once

#include "protocol/exit_codes.h"

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace ringdown::cli {

struct FolderBake {
  std::filesystem::path folder, output, materials;
  std::optional<std::string> material;  // of shapes without an object file; objects have their own
  std::vector<std::string> options;     // for each child, --material left out
  std::vector<std::string> hashed;      // those of them that can change a bank
  int jobs = 0;                         // at a time; 0: as many as there are processors, which they share
  bool recursive = false, force = false, check_budgets = false, quiet = false, progress = false;
};

// Prints a line for each object and a summary to stdout, and a sentence for each that failed to stderr. Exit codes:
// bad_input when an object failed or there are none; failure when the output folder cannot be made, or with
// check_budgets when a bake took more processor time than its object's budget_s; cancelled; ok.
protocol::ExitCode bake_folder(const FolderBake& request, const std::stop_token& stop);

}  // namespace ringdown::cli
