// A folder of small objects, and `ringdown bake` run on it. [one thread]
#pragma once

#include "tests/integration/process.h"
#include "tests/support/temporary_folder.h"

#include <functional>
#include <string>
#include <vector>

namespace ringdown::test {

// objects/ holds box.geo (a box with edges in millimetres, which includes parameters.geo), materials/ one material,
// "stuff". A box of linear elements takes some tenths of a second to bake.
class BoxFolder {
 public:
  BoxFolder();

  [[nodiscard]] std::filesystem::path objects() const { return folder_ / "objects"; }
  [[nodiscard]] std::filesystem::path banks() const { return folder_ / "banks"; }
  [[nodiscard]] std::filesystem::path bank(const std::string& name) const { return banks() / (name + ".glb"); }
  [[nodiscard]] std::filesystem::path materials() const { return folder_ / "materials"; }

  // A file below the folder itself.
  std::filesystem::path write(const std::string& name,
                              const std::string& text) const;  // NOLINT(modernize-use-nodiscard)
  void box(const std::string& name, int length_mm, const std::string& more = "") const;
  void slow(const std::string& name) const;  // an object that takes a minute or so

  // ringdown-bake objects() -o banks() and these. Without a cache, unless `options` says otherwise.
  [[nodiscard]] std::vector<std::string> command(std::vector<std::string> options = {}) const;
  [[nodiscard]] Outcome bake(const std::vector<std::string>& options = {}) const;
  [[nodiscard]] std::vector<std::string> whole_banks() const;  // names of files in banks() that read as banks, sorted
  [[nodiscard]] std::vector<std::string> files_in_banks() const;

 private:
  TemporaryFolder folder_;
};

// Processes that `parent` has started and that still run.
std::vector<pid_t> children_of(pid_t parent);
bool is_running(pid_t process);

// Asks again and again; false when it has not come true after minutes.
bool comes_true(const std::function<bool()>& condition);

}  // namespace ringdown::test
