// The command line's part of baking folders. [main]
#pragma once

#include "clients/cli/bake/folder_bake.h"
#include "engine/base/result.h"

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace ringdown::cli {

// Adds --jobs and the like, which fill `request`, and --update and --progress-lines, which are for one input.
void add_folder_options(CLI::App& app, FolderBake& request, bool& update, bool& progress_lines);

// Whether the options given are for what `input` is; `request.folder` stays empty unless that is a folder.
Result<void> choose_folder(const CLI::App& app, const std::filesystem::path& input, FolderBake& request);

// The given options that can change a bank and are not a name of a file (the file is hashed), for input_hash().
std::vector<std::string> shaping_options(const CLI::App& app);

// Bakes with the options that `app` was given, until a signal comes.
protocol::ExitCode run_folder_bake(const CLI::App& app, FolderBake request);

}  // namespace ringdown::cli
