#include "engine/scene/gltf/normal_map.h"

#include "engine/gltf/gltf_file.h"
#include "engine/scene/description.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

constexpr double kSteepest = 4;  // a normal that leans more than this slope is cut

struct Picture {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

std::optional<Picture> unpack_png(std::span<const std::byte> bytes) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, void (*)(png_image*)> guard(&png, [](png_image* p) { png_image_free(p); });
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) return {};
  if (png.width == 0 || png.height == 0 || png.width > kMaxMapPixels / png.height) return {};
  if (png.width > kMaxMapSamples) return {};
  // Reads the numbers unchanged: normals are not colours, and alpha, which is not read, does not affect them.
  png.format = PNG_FORMAT_RGBA;
  png.flags |= PNG_IMAGE_FLAG_COLORSPACE_NOT_sRGB;
  Picture picture{.width = png.width, .height = png.height};
  picture.rgba.resize(4 * picture.width * picture.height);
  if (!png_image_finish_read(&png, nullptr, picture.rgba.data(), 0, nullptr)) return {};
  return picture;
}

// Length in the world along u, for each unit of u: the mean over the triangles, weighted by their areas.
double length_of_u(GltfDocument& document, const JsonPlace& primitive, const JsonPlace& coordinates,
                   const Affine& map) {
  constexpr std::size_t kMax = 4 * kMaxMeshPoints;
  const auto points = modal::read_numbers(document.glb(), primitive["attributes"]["POSITION"], 3, kMax);
  const auto uv = modal::read_numbers(document.glb(), coordinates, 2, kMax);
  if (!points || !uv || uv->size() / 2 != points->size() / 3) return 0;
  std::vector<std::uint32_t> corners;
  if (primitive["indices"].present()) {
    auto read = modal::read_indices(document.glb(), primitive["indices"], 3 * kMax);
    if (!read) return 0;
    corners = *std::move(read);
  } else {
    for (std::uint32_t k = 0; k < points->size() / 3; ++k) corners.push_back(k);
  }
  double sum = 0, weights = 0;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    std::array<Vec3, 3> p;
    std::array<std::array<double, 2>, 3> t{};
    bool good = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = corners[c + k];
      good = good && n < points->size() / 3;
      if (!good) break;
      p[k] = map.linear * Vec3{(*points)[3 * n], (*points)[3 * n + 1], (*points)[3 * n + 2]};
      t[k] = {(*uv)[2 * n], (*uv)[2 * n + 1]};
    }
    if (!good) return 0;
    const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
    const double u1 = t[1][0] - t[0][0], v1 = t[1][1] - t[0][1], u2 = t[2][0] - t[0][0], v2 = t[2][1] - t[0][1];
    const double turn = u1 * v2 - u2 * v1, area = length(cross(e1, e2));
    if (!(std::abs(turn) > 1e-12)) continue;
    sum += area * length((1 / turn) * (v2 * e1 - v1 * e2));
    weights += area;
  }
  return weights > 0 ? sum / weights : 0;
}

// The heights whose slopes are those of the map's normals, without the mean slope, so that they close.
std::vector<float> heights_of(const Picture& picture, double strength, double texel_m) {
  const std::size_t rows = std::clamp<std::size_t>(kMaxMapSamples / picture.width, 1, picture.height);
  std::vector<double> slopes;
  slopes.reserve(rows * picture.width);
  double mean = 0;
  for (std::size_t k = 0; k < rows * picture.width; ++k) {
    const auto part = [&](std::size_t channel) {
      return static_cast<double>(picture.rgba[4 * k + channel]) * 2 / 255 - 1;
    };
    const double x = strength * part(0), z = std::max(part(2), 1e-3);
    slopes.push_back(std::clamp(-x / z, -kSteepest, kSteepest));
    mean += slopes.back();
  }
  mean /= static_cast<double>(slopes.size());
  std::vector<float> heights;
  heights.reserve(slopes.size());
  double height = 0;
  for (const double slope : slopes) {
    heights.push_back(static_cast<float>(height));
    height += (slope - mean) * texel_m;
  }
  return heights;
}

std::optional<Picture> picture_of(GltfDocument& document, const JsonPlace& info, const modal::ReadBeside& read_beside) {
  const JsonPlace texture = document.element(info["index"], document.root()["textures"]);
  const JsonPlace image = document.element(texture["source"], document.root()["images"]);
  if (!image.present()) return {};
  std::string bytes;
  if (image["bufferView"].present()) {
    const auto view = modal::read_view(document.glb(), image["bufferView"]);
    if (view && view->size() <= kMaxMapBytes) bytes.assign(reinterpret_cast<const char*>(view->data()), view->size());
  } else if (auto read = modal::read_uri(image["uri"].text_or(""), image["uri"].path(), kMaxMapBytes, read_beside)) {
    bytes = *std::move(read);
  }
  auto picture = unpack_png(std::as_bytes(std::span(bytes)));
  if (!picture)
    document.notes.add(formatted(
        "a normal map cannot be read, and is ignored: it must be a PNG of 16 million pixels at most, {} in a row",
        kMaxMapSamples));
  return picture;
}

}  // namespace

std::optional<modal::SurfaceTrack> relief_of(GltfDocument& document, const JsonPlace& own, const JsonPlace& mesh,
                                             const Affine& map, bool may_read, const modal::ReadBeside& read_beside) {
  for (std::size_t k = 0; k < mesh["primitives"].size(); ++k) {
    const JsonPlace primitive = mesh["primitives"][k];
    const JsonPlace material = document.element(primitive["material"], document.root()["materials"]);
    const JsonPlace info = own.present() ? own : material["normalTexture"];
    if (!info.present()) continue;
    if (!may_read) {
      document.notes.add(formatted("more than {} normal maps are ignored", kMaxMaps));
      return {};
    }
    if (info["extensions"]["KHR_texture_transform"].present())
      document.notes.add("a normal map is used without its KHR_texture_transform");
    const auto set = info["texCoord"].index_or(0).value_or(0);
    const JsonPlace coordinates = primitive["attributes"][formatted("TEXCOORD_{}", set)];
    const double strength = document.number(info["scale"], 1);
    const double u_m = coordinates.present() ? length_of_u(document, primitive, coordinates, map) : 0;
    if (!(u_m > 0)) {
      document.notes.add("a normal map is ignored if its mesh has no texture coordinates as floats");
      continue;
    }
    const auto picture = picture_of(document, info, read_beside);
    if (!picture) return {};
    const double texel_m = u_m / static_cast<double>(picture->width);
    auto track = modal::SurfaceTrack::make(heights_of(*picture, strength, texel_m), texel_m);
    if (track) return *std::move(track);
    document.notes.add("a normal map of one texel, or with heights that are not finite numbers, is ignored");
    return {};
  }
  return {};
}

}  // namespace ringdown::scene
