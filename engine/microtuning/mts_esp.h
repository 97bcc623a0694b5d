// A client of MTS-ESP, by which a "master" plug-in tunes all instruments of a computer. The master and its clients
// share a library, which users of MTS-ESP have installed and which is loaded when a client is made. This file knows the
// library's functions from its public client (github.com/ODDSound/MTS-ESP). [one thread, not audio]
#pragma once

#include "engine/microtuning/key_tuning.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace ringdown::microtuning {

class MtsEsp {
 public:
  // Where the library is: RINGDOWN_MTS_ESP of the environment, otherwise the place in which its installer puts it.
  static std::filesystem::path library();

  // Registers a client. Without the library there is never a master.
  explicit MtsEsp(const std::filesystem::path& library = MtsEsp::library());
  ~MtsEsp();
  MtsEsp(const MtsEsp&) = delete;
  MtsEsp& operator=(const MtsEsp&) = delete;

  // Returns the tuning as it is now; nothing while there is no master. Tables of single channels are not read, because
  // a key plays the same object on all channels.
  [[nodiscard]] std::optional<KeyTuning> tuning() const;

 private:
  struct Library;
  std::unique_ptr<const Library> library_;  // null: it is not installed
};

}  // namespace ringdown::microtuning
