// A file descriptor that closes itself. [any thread]
#pragma once

#include <unistd.h>
#include <utility>

namespace ringdown::wire {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int open) : open_(open) {}
  Descriptor(Descriptor&& other) noexcept : open_(std::exchange(other.open_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(open_, other.open_);
    return *this;
  }
  ~Descriptor() {
    if (open_ >= 0) ::close(open_);
  }
  [[nodiscard]] int get() const { return open_; }
  [[nodiscard]] bool is_open() const { return open_ >= 0; }

  // Returns the descriptor and gives up ownership; the caller closes it.
  [[nodiscard]] int release() { return std::exchange(open_, -1); }

 private:
  int open_ = -1;
};

}  // namespace ringdown::wire
