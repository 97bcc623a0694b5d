// gmsh between initialize() and finalize(). [worker; calls of several threads wait for each other, because gmsh keeps
// its state in globals]
#pragma once

#include <mutex>
#include <optional>
#include <string>

namespace ringdown::mesh {

// Silent, on one thread, so that the same input gives the same mesh on every machine.
class GmshSession {
 public:
  GmshSession();
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;

  // The first error logged so far, without its label.
  [[nodiscard]] std::optional<std::string> first_error() const;

 private:
  std::lock_guard<std::mutex> lock_;
};

}  // namespace ringdown::mesh
