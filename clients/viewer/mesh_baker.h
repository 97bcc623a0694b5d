// Bakes the files that users drop onto the window into banks, one after the other, each by a process `ringdown-bake` of
// its own: a mesh in a material, or an object file, which states its own.
//
//   baker.add("mug.stl", "porcelain");
//   for (const auto& bank : baker.take_banks()) commands.load_bank(bank);  // at every frame
//
// ringdown-bake checks the mesh and repairs or refuses it. The banks stay in a folder of the user's, each under a name
// that the file's path and material determine, so a file that is dropped again unchanged is not baked again. [UI]
#pragma once

#include "engine/base/result.h"

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ringdown::viewer {

enum class Dropped { bank, scene, object, mesh, unknown };

// Returns what a dropped file is, judged by its ending.
Dropped kind_of_drop(const std::filesystem::path& file);

class MeshBaker {
 public:
  // `program` is ringdown-bake, and `folder` gets the banks.
  MeshBaker(Result<std::filesystem::path> program, Result<std::filesystem::path> folder)
      : program_(std::move(program)), folder_(std::move(folder)) {}
  ~MeshBaker();  // ends the process that runs
  MeshBaker(const MeshBaker&) = delete;
  MeshBaker& operator=(const MeshBaker&) = delete;

  // `material` is empty for an object file.
  void add(const std::filesystem::path& file, const std::string& material);

  // A bake that waits, runs or has failed.
  struct Job {
    std::filesystem::path file;
    std::string material;
    std::string stage;    // "waits" at first
    double fraction = 0;  // done, of 1
    std::string failure;  // a sentence; empty: the bake did not fail
  };
  [[nodiscard]] std::vector<Job> jobs() const;

  // Returns whether a job waits or runs, or a bank is to be taken.
  [[nodiscard]] bool is_working() const;

  // Forgets a job that has failed, and cancels one that waits or runs.
  void remove(std::size_t job);

  // Returns the banks that have become ready since the last call.
  [[nodiscard]] std::vector<std::filesystem::path> take_banks();

 private:
  struct Entry {
    Job job;
    bool is_cancelled = false;
  };
  void work(const std::stop_token& stop);
  Result<std::filesystem::path> bake(Entry& entry, const std::stop_token& stop);

  const Result<std::filesystem::path> program_, folder_;
  mutable std::mutex mutex_;  // guards the members below
  std::condition_variable_any changed_;
  std::vector<std::shared_ptr<Entry>> entries_;
  std::vector<std::filesystem::path> banks_;
  std::jthread thread_;  // started by the first job; last, so that it ends first
};

}  // namespace ringdown::viewer
