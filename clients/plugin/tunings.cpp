#include "clients/plugin/tunings.h"

#include "clients/plugin/sources.h"
#include "engine/base/formatted.h"
#include "engine/microtuning/scala.h"

#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

namespace ringdown::plugin {

std::string tuning_name(std::size_t choice) {
  if (choice == 0 || choice >= kFirstOwnTuning + kOwnTunings) return "equal temperament";
  return choice == kHostTuning ? "file" : formatted("own {}", choice - kFirstOwnTuning + 1);
}

void Tunings::set_file(File file, const std::string& path) {
  const std::lock_guard lock(mutex_);
  std::string& held = files_[static_cast<std::size_t>(file)];
  is_other_ = is_other_ || !path.empty() || !held.empty();  // the same file may hold something else now
  held = path;
}

std::string Tunings::file(File file) const {
  const std::lock_guard lock(mutex_);
  return files_[static_cast<std::size_t>(file)];
}

microtuning::KeyTuning Tunings::read(std::size_t choice, const std::optional<microtuning::KeyTuning>& of_map) {
  if (choice == 0) {
    choice_ = 0;
    read_ = {};
    return of_map ? *of_map : mts_esp_.tuning().value_or(microtuning::KeyTuning{});
  }
  read_files(choice);
  return read_;
}

// Reads the files if they are not those that were read last. One of the two may be missing.
void Tunings::read_files(std::size_t choice) {
  std::array<std::filesystem::path, 2> paths;
  {
    const std::lock_guard lock(mutex_);
    const bool is_other = std::exchange(is_other_, false) && choice == kHostTuning;
    if (choice == choice_ && !is_other) return;
    paths = {files_[0], files_[1]};
  }
  choice_ = choice;
  if (choice >= kFirstOwnTuning) {
    const std::string number = formatted("{}", choice - kFirstOwnTuning + 1);
    paths = {own_folder() / (number + ".scl"), own_folder() / (number + ".kbm")};
    std::error_code ignored;
    if (!std::filesystem::exists(paths[1], ignored)) {
      paths[1].clear();
    } else if (!std::filesystem::exists(paths[0], ignored)) {
      paths[0].clear();
    }
  }
  const auto tuning = microtuning::read_tuning(paths[0], paths[1]);
  if (tuning) {
    read_ = *tuning;
  } else {
    std::fprintf(stderr, "Ringdown: %s\n", tuning.error().message.c_str());
  }
}

}  // namespace ringdown::plugin
