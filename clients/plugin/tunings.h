// The tuning of the keys that the parameter "Scale" chooses: files of Scala (.scl and .kbm), or none. With none, a note
// map's own tuning counts; for other sources, that of a master of MTS-ESP while there is one.
#pragma once

#include "engine/microtuning/key_tuning.h"
#include "engine/microtuning/mts_esp.h"

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>

namespace ringdown::plugin {

// Choice 0 has no files, choice 1 those that the host chose; then come files of the user's folder: 1.scl and 1.kbm ...
inline constexpr std::size_t kOwnTunings = 8;
inline constexpr std::size_t kHostTuning = 1, kFirstOwnTuning = 2;

// Returns a choice as shown to people: "equal temperament", "file", "own 3".
std::string tuning_name(std::size_t choice);

class Tunings {
 public:
  enum class File : std::size_t { scale, mapping };

  // The files of choice 1; "": none. [any but audio]
  void set_file(File file, const std::string& path);
  [[nodiscard]] std::string file(File file) const;

  // Returns the tuning of a choice as it is now, for keys that play a note map with a tuning of its own, or without
  // one. If a file cannot be read, standard error says why, once, and the tuning stays as it was. [worker]
  microtuning::KeyTuning read(std::size_t choice, const std::optional<microtuning::KeyTuning>& of_map);

 private:
  void read_files(std::size_t choice);

  mutable std::mutex mutex_;  // guards files_ and is_other_
  std::array<std::string, 2> files_;
  bool is_other_ = true;    // whether a file has changed
  std::size_t choice_ = 0;  // the choice whose files were read last
  microtuning::KeyTuning read_;
  microtuning::MtsEsp mts_esp_;
};

}  // namespace ringdown::plugin
