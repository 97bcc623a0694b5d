// The command line of a folder bake. [main]
#pragma once

#include "clients/cli/bake/folder_bake.h"
#include "engine/base/result.h"

#include <string>
#include <vector>

namespace ringdown::manual {
class App;
}

namespace ringdown::cli {

// Adds --jobs and the like, which fill `request`, and --update and --progress-lines, which are for one input.
void add_folder_options(manual::App& app, FolderBake& request, bool& update, bool& progress_lines);

// Sets `request.folder` when `input` is a folder. Fails with ErrorKind::usage when an option was given that does not
// apply to the input (to a folder, or to a single file), with bad_input when it is for a folder that is not there.
Result<void> choose_folder(const manual::App& app, const std::filesystem::path& input, FolderBake& request);

// The given options that can change a bank, for input_hash(). Names of files are left out: the files are hashed.
std::vector<std::string> shaping_options(const manual::App& app);

// Bakes with the options that `app` was given. SIGINT or SIGTERM ends the bake.
protocol::ExitCode run_folder_bake(const manual::App& app, FolderBake request);

}  // namespace ringdown::cli
