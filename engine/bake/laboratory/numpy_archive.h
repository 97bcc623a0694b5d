// Arrays for numpy.load(): a .npz, which is a zip file of .npy files without compression. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace ringdown::bake {

class NumpyArchive {
 public:
  // Adds an array of doubles or 32-bit integers, in C's order. Each name is added once.
  template <class Number>
  void add(const std::string& name, const std::vector<std::size_t>& shape, const Number* numbers) {
    static_assert(std::is_same_v<Number, double> || std::is_same_v<Number, std::int32_t>);
    std::size_t count = 1;
    for (const std::size_t extent : shape) count *= extent;
    add_bytes(name, shape, std::is_same_v<Number, double> ? "<f8" : "<i4", numbers, count * sizeof(Number));
  }

  // Returns the file's bytes. Fails if they would be 4 GB or more.
  [[nodiscard]] Result<std::string> finish() &&;

 private:
  void add_bytes(const std::string& name, const std::vector<std::size_t>& shape, const char* type, const void* numbers,
                 std::size_t bytes);

  std::string files_, directory_;
  std::uint16_t count_ = 0;
};

}  // namespace ringdown::bake
