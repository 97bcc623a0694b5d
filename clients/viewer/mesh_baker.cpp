#include "clients/viewer/mesh_baker.h"

#include "engine/base/content_hash.h"
#include "engine/base/file_format.h"
#include "engine/base/process/child_process.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

namespace ringdown::viewer {
namespace {

namespace fs = std::filesystem;

// A table is a scene if its folder is called "scenes", as in the daemon's list of files.
bool is_scene(const fs::path& file) {
  return is_of_kind(file, FileKind::table) && file.parent_path().filename() == "scenes";
}

// Returns the name of a file's bank: "mug-porcelain-3f81c2.glb". The digits are a hash of the file's path, so that
// files of one name in several folders, or of several formats, have banks of their own.
std::string bank_name(const fs::path& file, const std::string& material) {
  constexpr std::size_t kDigits = 6;
  std::error_code failed;
  fs::path path = fs::weakly_canonical(file, failed);
  if (failed) path = fs::absolute(file, failed);
  const std::string digits = hash_of(path.string()).text().substr(0, kDigits);
  return file.stem().string() + (material.empty() ? "" : "-" + material) + "-" + digits + ".glb";
}

}  // namespace

Dropped kind_of_drop(const fs::path& file) {
  const FileFormat* const format = format_of(file);
  if (!format) return Dropped::unknown;
  if (has_ending(file, ".glb")) return Dropped::bank;
  if (format->kind == FileKind::gltf || is_scene(file)) return Dropped::scene;
  if (format->kind == FileKind::table) return Dropped::object;
  return format->kind == FileKind::sound ? Dropped::unknown : Dropped::mesh;
}

MeshBaker::~MeshBaker() {
  thread_.request_stop();
  changed_.notify_all();
}

void MeshBaker::add(const fs::path& file, const std::string& material) {
  const std::scoped_lock lock(mutex_);
  entries_.push_back(std::make_shared<Entry>(Entry{{.file = file, .material = material, .stage = "waits"}}));
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
  changed_.notify_all();
}

std::vector<MeshBaker::Job> MeshBaker::jobs() const {
  const std::scoped_lock lock(mutex_);
  std::vector<Job> jobs;
  for (const auto& entry : entries_) jobs.push_back(entry->job);
  return jobs;
}

bool MeshBaker::is_working() const {
  const std::scoped_lock lock(mutex_);
  return !banks_.empty() || std::ranges::any_of(entries_, [](const auto& e) { return e->job.failure.empty(); });
}

void MeshBaker::remove(std::size_t job) {
  const std::scoped_lock lock(mutex_);
  if (job >= entries_.size()) return;
  entries_[job]->is_cancelled = true;
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(job));
}

std::vector<fs::path> MeshBaker::take_banks() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(banks_, {});
}

void MeshBaker::work(const std::stop_token& stop) {
  const auto waiting = [this] {
    return std::ranges::find_if(entries_, [](const auto& entry) { return entry->job.failure.empty(); });
  };
  while (!stop.stop_requested()) {
    std::shared_ptr<Entry> entry;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return waiting() != entries_.end(); })) return;
      entry = *waiting();
    }
    const Result<fs::path> bank = bake(*entry, stop);
    const std::scoped_lock lock(mutex_);
    if (entry->is_cancelled) continue;
    if (!bank) {
      entry->job.failure = bank.error().message;
      continue;
    }
    std::erase(entries_, entry);
    banks_.push_back(*bank);
  }
}

// Lines of progress are "FRACTION STAGE".
Result<fs::path> MeshBaker::bake(Entry& entry, const std::stop_token& stop) {
  if (!program_) return program_;
  if (!folder_) return folder_;
  const fs::path& file = entry.job.file;
  const std::string& material = entry.job.material;
  fs::path bank = *folder_ / bank_name(file, material);
  ChildRequest child{
      .command = {program_->string(), file.string(), "-o", bank.string(), "--quiet", "--progress-lines", "--update"}};
  if (!material.empty()) child.command.insert(child.command.end(), {"--material", material});
  child.on_line = [&](std::string_view line) {
    const std::size_t blank = line.find(' ');
    if (blank == std::string_view::npos) return;
    const std::scoped_lock lock(mutex_);
    entry.job.fraction = std::strtod(std::string(line.substr(0, blank)).c_str(), nullptr);
    entry.job.stage = line.substr(blank + 1);
  };
  child.keep_going = [&] {
    const std::scoped_lock lock(mutex_);
    return !stop.stop_requested() && !entry.is_cancelled;
  };
  const Result<ChildOutcome> outcome = run_child(child);
  if (!outcome) return fail(outcome);
  if (outcome->exit_code == 0) return bank;
  const std::string why = last_line(outcome->errors);
  return fail(ErrorKind::bad_input, why.empty() ? "ringdown-bake ended and said nothing" : why);
}

}  // namespace ringdown::viewer
