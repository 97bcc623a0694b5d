// Pictures as PNG files. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace ringdown::viewer {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4, sRGB, from the top left corner, alpha not multiplied in

  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return rgba.data() +
           4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

// Atomically: a reader sees the old file or the new one.
Result<void> write_png(const Image& image, const std::filesystem::path& path);

}  // namespace ringdown::viewer
