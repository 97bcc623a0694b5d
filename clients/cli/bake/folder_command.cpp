#include "clients/cli/bake/folder_command.h"

#include "clients/cli/bake/exports.h"

#include "clients/cli/long_work.h"
#include "engine/bake/recipe_options.h"
#include "packaging/manual/command_line.h"

namespace ringdown::cli {
namespace {

constexpr auto kForFolders = {"--jobs", "--recursive", "--force", "--check-budgets"};
constexpr auto kForOne = {"--name", "--update", "--progress-lines"};

}  // namespace

void add_folder_options(manual::App& app, FolderBake& request, bool& update, bool& progress_lines) {
  app.add_option("-j,--jobs", request.jobs,
                 "for a folder: number of bakes at a time (default: the number of processors)")
      ->check(manual::between(1, 4096));
  app.add_flag("--recursive", request.recursive, "for a folder: include its subfolders");
  app.add_flag("--force", request.force, "for a folder: also bake unchanged objects");
  app.add_flag("--check-budgets", request.check_budgets,
               "for a folder: exit code 1 if a bake took more processor time than its object's budget_s");
  app.add_flag("--update", update, "bake nothing if the bank exists and was made from the same inputs");
  app.add_flag("--progress-lines", progress_lines, "for programs: progress as lines 'FRACTION STAGE' on stdout");
}

Result<void> choose_folder(const manual::App& app, const std::filesystem::path& input, FolderBake& request) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(input, error);
  const bool is_there = std::filesystem::exists(input, error);
  for (const char* name : is_folder ? kForOne : kForFolders) {
    if (app.count(name) == 0) continue;
    if (!is_there) return fail(ErrorKind::bad_input, "there is no folder " + input.string());
    return fail(ErrorKind::usage, "{} is for {}{}{}", name, is_folder ? "one input, and " : "a folder, and ",
                input.string(), is_folder ? " is a folder" : " is none");
  }
  if (is_folder) request.folder = input;
  return {};
}

std::vector<std::string> shaping_options(const manual::App& app) {
  std::vector<std::string_view> others = {"--output",    "--material",       "--materials",     "--jobs",
                                          "--recursive", "--force",          "--check-budgets", "--update",
                                          "--progress",  "--progress-lines", "--quiet"};
  others.insert(others.end(), kExportOptions.begin(), kExportOptions.end());
  for (const bake::RecipeOption& option : bake::recipe_options()) {
    if (option.has(bake::RecipeOption::kSameBank)) others.push_back(option.option);
  }
  return app.given_options(others);
}

protocol::ExitCode run_folder_bake(const manual::App& app, FolderBake request) {
  constexpr std::chrono::seconds kPatience{10};  // its children end within one
  if (request.output.empty()) request.output = request.folder;
  request.hashed = shaping_options(app);
  request.options = app.given_options(
      {"--output", "--material", "--jobs", "--recursive", "--force", "--check-budgets", "--progress", "--quiet"});
  return run_cancellable([&request](const std::stop_token& stop) { return bake_folder(request, stop); }, kPatience);
}

}  // namespace ringdown::cli
