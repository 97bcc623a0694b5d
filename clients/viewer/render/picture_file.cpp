#include "clients/viewer/render/picture_file.h"

#include "engine/base/output_file.h"

#include <png.h>

#include <cassert>
#include <span>

namespace ringdown::viewer {

Result<void> write_png(const Image& image, const std::filesystem::path& path) {
  assert(image.width > 0 && image.height > 0 &&
         image.rgba.size() ==
             std::size_t{4} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGBA;
  std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr))
    return fail(ErrorKind::input_output, "the picture {} could not be made: {}", path.string(), png.message);
  return write_output(path, std::span(bytes).first(size));
}

}  // namespace ringdown::viewer
