// Pictures in memory, and how they become PNG files. [worker]
#pragma once

#include "engine/base/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace ringdown::viewer {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4, sRGB, from the top left corner, straight alpha

  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return rgba.data() +
           4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

// Writes the image atomically: a reader sees the old file or the new one. Fails when the file cannot be written.
Result<void> write_png(const Image& image, const std::filesystem::path& path);

}  // namespace ringdown::viewer
