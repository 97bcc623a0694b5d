// A daemon of the viewer's own, without a sound card, for pictures. [worker]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <memory>
#include <string>

namespace ringdown::viewer {

class LocalDaemon {
 public:
  // Starts `ringdownd`, which lies beside this program, on a free port, and waits until it is ready. It may read
  // `scene` and what that names. Fails with what it said.
  static Result<LocalDaemon> start(const std::filesystem::path& scene);
  LocalDaemon(LocalDaemon&&) noexcept;
  LocalDaemon& operator=(LocalDaemon&&) noexcept;
  ~LocalDaemon();  // ends it

  [[nodiscard]] const std::string& url() const;

 private:
  struct State;
  explicit LocalDaemon(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::viewer
