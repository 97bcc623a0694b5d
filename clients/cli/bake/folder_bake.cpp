#include "clients/cli/bake/folder_bake.h"

#include "clients/cli/bake/folder_jobs.h"
#include "clients/cli/bake/job_board.h"
#include "engine/bake/input_hash.h"
#include "engine/bake/object_file.h"
#include "engine/base/file_format.h"
#include "engine/base/in_parallel.h"
#include "engine/base/process/child_process.h"
#include "engine/modal/bank_file.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <set>
#include <utility>
#include <unistd.h>

namespace ringdown::cli {
namespace {

namespace fs = std::filesystem;
using protocol::complain;
using protocol::ExitCode;

constexpr auto kLeftover = std::chrono::minutes(1);  // a bank is written in milliseconds

enum class State { waiting, unchanged, baked, failed };

struct Job {
  FolderJob file;
  State state = State::waiting;
  std::string why;  // it failed
  double seconds = 0, processor_s = 0, peak_mib = 0;
  double budget_s = 0;  // 0: none
  [[nodiscard]] bool over() const { return state == State::baked && budget_s > 0 && processor_s > budget_s; }
};

bool is_object(const FolderJob& job) { return is_of_kind(job.input, FileKind::table); }

std::vector<std::string> with_material(std::vector<std::string> options, const FolderBake& request,
                                       const FolderJob& job) {
  if (!is_object(job)) options.insert(options.end(), {"--material", *request.material});
  return options;
}

// Reads the text of a job and says whether it cannot be baked, or need not be.
void look_at(Job& job, const FolderBake& request) {
  const auto refuse = [&job](const std::string& why) {
    job.state = State::failed;
    job.why = why;
  };
  if (!job.file.refused.empty()) return refuse(job.file.refused);
  bake::ObjectRecipe recipe{.material = request.material.value_or(""), .geometry = job.file.input};
  if (is_object(job.file)) {
    Result<bake::ObjectRecipe> object = bake::read_object(job.file.input);
    if (!object) return refuse(object.error().message);
    recipe = std::move(*object);
  }
  job.budget_s = recipe.budget_s;
  if (request.force) return;
  const auto hash = bake::input_hash({.object = job.file.input,
                                      .geometry = recipe.geometry,
                                      .material = request.materials / (recipe.material + ".toml"),
                                      .options = request.hashed,
                                      .part_materials = bake::part_materials(recipe, request.materials),
                                      .part_surfaces = bake::part_surfaces(recipe)});
  if (hash && modal::read_input_hash(job.file.output) == hash) job.state = State::unchanged;
}

// Banks that a killed process left half-written, under the names of write_file_atomically(): NAME.glb.XXXXXX.
void remove_leftovers(const std::vector<Job>& jobs) {
  constexpr std::size_t kLetters = 7;
  std::set<fs::path> folders, banks;
  for (const Job& job : jobs) folders.insert(job.file.output.parent_path()), banks.insert(job.file.output);
  for (const fs::path& folder : folders) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      const std::string path = entry->path().string();
      if (path.size() <= kLetters || path[path.size() - kLetters] != '.') continue;
      if (!banks.contains(path.substr(0, path.size() - kLetters))) continue;
      std::error_code gone;
      const auto age = fs::file_time_type::clock::now() - entry->last_write_time(gone);
      if (!gone && age > kLeftover) fs::remove(entry->path(), gone);
    }
  }
}

// Why a child ended as it did, in one sentence.
std::string reason_of(const ChildOutcome& outcome) {
  constexpr std::string_view kPrefix = "ringdown-bake: ";
  const int signal = outcome.exit_code - 128;
  if (outcome.exit_code == static_cast<int>(ExitCode::cancelled)) return "its process was interrupted";
  if (signal > 0) {
    std::string why = formatted("its process was ended by signal {} ({}) at {:.0f} MiB", signal, ::strsignal(signal),
                                outcome.peak_mib);
    if (signal == SIGKILL) why += ", as the kernel does when memory runs out; try fewer --jobs or a larger --mesh-size";
    return why;
  }
  const std::string line = last_line(outcome.errors);
  if (line.empty()) return formatted("its process ended with exit code {} and said nothing", outcome.exit_code);
  return line.starts_with(kPrefix) ? line.substr(kPrefix.size()) : line;
}

std::string line_of(const Job& job) {
  if (job.state == State::failed) return job.file.name + ": failed";
  std::string line =
      formatted("{}: baked, {:.1f} s, {:.1f} s of processor time", job.file.name, job.seconds, job.processor_s);
  if (job.budget_s > 0) line += formatted(" (budget {:.3g} s){}", job.budget_s, job.over() ? " OVER" : "");
  return formatted("{}, {:.0f} MiB", line, job.peak_mib);
}

class BakePool {
 public:
  BakePool(const FolderBake& request, std::vector<Job*> waiting, JobBoard& board, const std::stop_token& stop)
      : request_(request), waiting_(std::move(waiting)), board_(board), stop_(stop) {
    const int processors = thread_count(0), jobs = request.jobs > 0 ? request.jobs : processors;
    workers_ = std::min(jobs, static_cast<int>(waiting_.size()));
    threads_ = std::to_string(std::max(1, processors / std::max(1, workers_)));
  }

  void work() {
    if (workers_ == 0) return;
    in_parallel(workers_, [this](int) {
      for (std::size_t i; !stop_.stop_requested() && (i = next_++) < waiting_.size();) bake(*waiting_[i]);
    });
  }

 private:
  void bake(Job& job) {
    std::error_code error;
    const std::string program = fs::read_symlink("/proc/self/exe", error).string();
    fs::create_directories(job.file.output.parent_path(), error);
    ChildRequest child{.command = {program, job.file.input, "-o", job.file.output, "--quiet", "--progress-lines"}};
    const std::vector<std::string> options = with_material(request_.options, request_, job.file);
    child.command.insert(child.command.end(), options.begin(), options.end());
    child.environment = {
        {"RINGDOWN_THREADS", threads_}, {"OPENBLAS_NUM_THREADS", threads_}, {"OMP_NUM_THREADS", threads_}};
    child.on_line = [&](std::string_view line) { show(job, line); };
    child.keep_going = [this] {
      board_.tick();
      return !stop_.stop_requested();
    };
    board_.begin(job.file.name);
    const Result<ChildOutcome> outcome = run_child(child);
    if (outcome && stop_.stop_requested() && outcome->exit_code != 0) return;  // it waits for the next run
    job.state = outcome && outcome->exit_code == 0 ? State::baked : State::failed;
    if (!outcome) job.why = outcome.error().message;
    if (outcome) {
      job.seconds = outcome->seconds;
      job.processor_s = outcome->processor_s;
      job.peak_mib = outcome->peak_mib;
      if (outcome->exit_code != 0) job.why = reason_of(*outcome);
    }
    board_.end(job.file.name, line_of(job));
  }

  // "0.425 STAGE"
  void show(const Job& job, std::string_view line) {
    const std::size_t blank = line.find(' ');
    if (blank == std::string_view::npos) return;
    const double fraction = std::strtod(std::string(line.substr(0, blank)).c_str(), nullptr);
    board_.stage(job.file.name, std::string(line.substr(blank + 1)), fraction);
  }

  const FolderBake& request_;
  const std::vector<Job*> waiting_;
  JobBoard& board_;
  const std::stop_token stop_;
  int workers_ = 1;
  std::string threads_;
  std::atomic<std::size_t> next_ = 0;
};

JobBoard::Style style_of(const FolderBake& request) {
  if (request.quiet) return JobBoard::Style::none;
  if (::isatty(STDERR_FILENO)) return JobBoard::Style::live;
  return request.progress ? JobBoard::Style::lines : JobBoard::Style::done;
}

ExitCode sum_up(const std::vector<Job>& jobs, const FolderContent& content, const FolderBake& request, bool cancelled,
                double seconds) {
  const auto count = [&jobs](State state) {
    return std::count_if(jobs.begin(), jobs.end(), [state](const Job& job) { return job.state == state; });
  };
  const auto over = std::count_if(jobs.begin(), jobs.end(), [](const Job& job) { return job.over(); });
  double processor_s = 0;
  for (const Job& job : jobs) processor_s += job.processor_s;
  std::string line = formatted("{}{}{} baked, {} unchanged, {} failed", jobs.size(),
                               jobs.size() == 1 ? " object: " : " objects: ", count(State::baked),
                               count(State::unchanged), count(State::failed));
  if (cancelled) line += formatted(", {} not done", count(State::waiting));
  if (over > 0) line += formatted(", {} over budget", over);
  line += formatted("; {:.1f} s, {:.1f} s of processor time", seconds, processor_s);
  if (!request.quiet) std::printf("%s\n", line.c_str());
  if (!request.quiet && content.shapes_without > 0) {
    std::printf("left out: %zu shapes without an object file; --material bakes them\n", content.shapes_without);
  }
  std::fflush(stdout);
  for (const Job& job : jobs) {
    if (job.state != State::failed) continue;
    const std::string name = job.file.name + ": ";  // which many sentences begin with
    complain((job.why.starts_with(name) ? "" : name) + job.why, ExitCode::bad_input);
  }
  if (cancelled) return complain("cancelled; the same command continues from here", ExitCode::cancelled);
  if (count(State::failed) > 0) return ExitCode::bad_input;
  return over > 0 && request.check_budgets ? ExitCode::failure : ExitCode::ok;
}

}  // namespace

ExitCode bake_folder(const FolderBake& request, const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  const Result<FolderContent> content = content_of({.folder = request.folder,
                                                    .output = request.output,
                                                    .recursive = request.recursive,
                                                    .with_shapes = request.material.has_value()});
  if (!content) return complain(content);
  std::error_code error;
  fs::create_directories(request.output, error);
  if (error) {
    return complain(
        {ErrorKind::input_output, "cannot make the folder " + request.output.string() + ": " + error.message()});
  }

  std::vector<Job> jobs;
  for (const FolderJob& file : content->jobs) jobs.push_back({.file = file});
  remove_leftovers(jobs);
  std::vector<Job*> waiting;
  for (Job& job : jobs) {
    if (stop.stop_requested()) break;
    look_at(job, request);
    if (job.state == State::waiting) waiting.push_back(&job);
  }
  JobBoard board(style_of(request), waiting.size());
  BakePool(request, std::move(waiting), board, stop).work();
  board.clear();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool cancelled = stop.stop_requested() && std::any_of(jobs.begin(), jobs.end(), [](const Job& job) {
                           return job.state == State::waiting;
                         });
  return sum_up(jobs, *content, request, cancelled, seconds);
}

}  // namespace ringdown::cli
