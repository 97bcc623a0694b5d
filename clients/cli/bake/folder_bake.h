// Bakes the objects of a folder whose banks are out of date, each in a process of its own. [worker]
//
// The parent starts several processes `ringdown-bake INPUT -o OUTPUT ...` at a time and reads their progress from
// pipes. The parent bakes nothing itself, so a mesh that crashes gmsh or needs all the memory does not affect the other
// banks. A bank that is whole and carries the hash of its present inputs (engine/bake/input_hash.h) is left alone. The
// children end when the parent ends, for whatever reason; finished banks remain, so the same command resumes the work.
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
  std::optional<std::string> material;  // for shapes without an object file; objects name their own
  std::vector<std::string> options;     // for each child, without --material
  std::vector<std::string> hashed;      // the options that can change a bank
  int jobs = 0;                         // number of processes at a time; 0: one for each processor
  bool recursive = false, force = false, check_budgets = false, quiet = false, progress = false;
};

// Prints a line for each object and a summary to stdout, and a sentence for each that failed to stderr. Exit codes:
// bad_input when an object failed or there are none; failure when the output folder cannot be made, or with
// check_budgets when a bake took more processor time than its object's budget_s; cancelled; ok.
protocol::ExitCode bake_folder(const FolderBake& request, const std::stop_token& stop);

}  // namespace ringdown::cli
