#include "engine/bake/input_hash.h"

#include "engine/base/atomic_file.h"
#include "engine/base/content_hash.h"
#include "engine/base/file_format.h"
#include "engine/base/version.h"
#include "engine/mesh/files/geo_language.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace ringdown::bake {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 3;                                   // of what is hashed
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;  // bytes

using Files = std::vector<fs::path>;

std::string lower(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) { return std::tolower(c); });
  return small;
}

// The values of every "uri" that are not data themselves.
std::optional<Files> named_by_gltf(std::string_view text) {
  Files files;
  for (std::size_t at = 0; (at = text.find("\"uri\"", at)) != std::string_view::npos;) {
    const std::size_t start = text.find('"', at + 5), end = text.find('"', start + 1);
    if (start == std::string_view::npos || end == std::string_view::npos) return std::nullopt;
    const std::string_view name = text.substr(start + 1, end - start - 1);
    if (name.find_first_of("\\%") != std::string_view::npos) return std::nullopt;  // escaped
    if (!name.starts_with("data:")) files.emplace_back(name);
    at = end;
  }
  return files;
}

std::optional<Files> named_by(const fs::path& path) {
  const FileFormat* format = format_of(path);
  if (!format || format->companions == Companions::none) return Files{};
  if (format->companions == Companions::siblings) {
    Files files;
    for (const std::string_view ending : format->siblings) {
      std::error_code error;
      const fs::path sibling = fs::path(path.filename()).replace_extension(ending);
      if (fs::exists(path.parent_path() / sibling, error)) files.push_back(sibling);
    }
    return files;
  }
  const Result<std::string> text = read_whole_file(path, kMaxFileBytes);
  if (!text) return std::nullopt;
  if (format->kind == FileKind::program) return mesh::files_named_by_geo(*text);
  if (format->companions == Companions::uris) return named_by_gltf(*text);
  return lower(*text).find("include") == std::string::npos ? std::optional(Files{}) : std::nullopt;
}

}  // namespace

std::optional<Files> files_of_geometry(const fs::path& geometry) {
  Files files = {geometry};
  for (std::size_t next = 0; next < files.size(); ++next) {
    const std::optional<Files> named = named_by(files[next]);
    if (!named) return std::nullopt;
    for (const fs::path& name : *named) {
      const fs::path file = (files[next].parent_path() / name).lexically_normal();
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
      if (files.size() > mesh::kMaxGeoFiles) return std::nullopt;
    }
  }
  return files;
}

std::optional<std::string> input_hash(const BankInputs& inputs) {
  std::optional<Files> files = files_of_geometry(inputs.geometry);
  if (!files) return std::nullopt;
  if (inputs.object != inputs.geometry) files->push_back(inputs.object);
  files->push_back(inputs.material);
  files->insert(files->end(), inputs.part_materials.begin(), inputs.part_materials.end());
  for (const fs::path& surface : inputs.part_surfaces) {
    const std::optional<Files> own = files_of_geometry(surface);
    if (!own) return std::nullopt;
    files->insert(files->end(), own->begin(), own->end());
  }
  ContentHasher hasher;
  hasher.value(kFormat).text(kBakesUnchangedSince).text(inputs.object.filename().string());
  for (const fs::path& file : *files) {
    const Result<std::string> content = read_whole_file(file, kMaxFileBytes);
    if (!content) return std::nullopt;
    hasher.text(*content);
  }
  for (const std::string& option : inputs.options) hasher.text(option);
  return hasher.hash().text();
}

}  // namespace ringdown::bake
