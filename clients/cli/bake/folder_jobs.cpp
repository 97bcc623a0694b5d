#include "clients/cli/bake/folder_jobs.h"

#include "engine/bake/input_hash.h"
#include "engine/bake/object_file.h"
#include "engine/base/file_format.h"
#include "engine/mesh/files/file_kinds.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace ringdown::cli {
namespace {

namespace fs = std::filesystem;

template <class Iterator>
Result<std::vector<fs::path>> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  Iterator entry(folder, error);
  for (; !error && entry != Iterator(); entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with('.');
    if constexpr (std::is_same_v<Iterator, fs::recursive_directory_iterator>) {
      if (hidden && entry->is_directory()) entry.disable_recursion_pending();
    }
    std::error_code gone;
    if (!hidden && entry->is_regular_file(gone)) files.push_back(entry->path());
  }
  if (error) return fail(ErrorKind::bad_input, "cannot read the folder {}: {}", folder.string(), error.message());
  std::sort(files.begin(), files.end());
  return files;
}

fs::path canonical_name(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  return error ? path : whole;
}

// Adds to `used` the files that a shape reads, and its own if `itself`.
void note_files(const fs::path& geometry, bool itself, std::set<fs::path>& used) {
  if (itself) used.insert(canonical_name(geometry));
  const auto files = bake::files_of_geometry(geometry);
  for (std::size_t i = 1; files && i < files->size(); ++i) used.insert(canonical_name((*files)[i]));
}

}  // namespace

Result<FolderContent> content_of(const FolderQuestion& question) {
  const auto files = question.recursive ? files_below<fs::recursive_directory_iterator>(question.folder)
                                        : files_below<fs::directory_iterator>(question.folder);
  if (!files) return fail(files);

  std::set<fs::path> used;
  std::map<std::string, FolderJob> jobs;  // by name
  const auto job_for = [&](const fs::path& input) {
    const fs::path below = input.lexically_relative(question.folder).replace_extension();
    return FolderJob{below.string(), input, question.output / (below.string() + ".glb"), ""};
  };
  for (const fs::path& file : *files) {
    if (is_of_kind(file, FileKind::table)) {
      FolderJob job = job_for(file);
      jobs.emplace(job.name, job);
      if (const auto recipe = bake::read_object(file)) note_files(recipe->geometry, true, used);
    } else if (mesh::is_body_file(file)) {
      note_files(file, false, used);
    }
  }

  FolderContent content;
  for (const fs::path& file : *files) {
    if (!mesh::is_body_file(file) || used.contains(canonical_name(file))) continue;
    FolderJob job = job_for(file);
    const auto other = jobs.find(job.name);
    if (other != jobs.end() && is_of_kind(other->second.input, FileKind::table)) continue;
    if (!question.with_shapes) {
      ++content.shapes_without;
    } else if (other != jobs.end()) {
      other->second.refused =
          formatted("{} and {} would both become {}; rename one of them", other->second.input.filename().string(),
                    file.filename().string(), job.output.filename().string());
    } else {
      jobs.emplace(job.name, std::move(job));
    }
  }
  for (auto& [name, job] : jobs) content.jobs.push_back(std::move(job));
  if (!content.jobs.empty()) return content;
  return fail(ErrorKind::bad_input,
              "there are no objects in " + question.folder.string() +
                  (content.shapes_without > 0 ? "; --material bakes shapes without an object file" : ""));
}

}  // namespace ringdown::cli
