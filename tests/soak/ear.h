// Listens to ringdownd's outputs by JACK and looks at every sample. Where the server restarts, make a new one.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

namespace ringdown::test {

struct Heard {
  std::atomic<std::uint64_t> samples{0};
  std::atomic<std::uint64_t> not_finite{0};
  std::atomic<std::uint64_t> loud{0};  // samples that are not silence
};

class Ear {
 public:
  // Adds to `heard`, which must outlive it.
  Ear(const std::string& server, Heard& heard);
  ~Ear();
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  // Connects ringdownd's outputs to it; false while they are not there.
  bool connect();

 private:
  struct Jack;
  std::unique_ptr<Jack> jack_;
};

}  // namespace ringdown::test
