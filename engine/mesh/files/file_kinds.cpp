#include "engine/mesh/files/file_kinds.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/mesh/files/geo_language.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace ringdown::mesh {
namespace {

// Dataset 164 gives the factor by which a length in metres becomes one of the file's. It stands near the beginning.
double unit_of_unv(const std::filesystem::path& path) {
  std::string head(std::size_t{1} << 20, '\0');
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return 1;
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  std::istringstream lines(head);
  std::string before, line, next;
  for (; std::getline(lines, line); before = line) {
    if (std::atoi(before.c_str()) == -1 && line.size() < 12 && std::atoi(line.c_str()) == 164) break;
  }
  if (!lines || !std::getline(lines, line) || !std::getline(lines, next)) return 1;
  std::replace(next.begin(), next.end(), 'D', 'E');
  const double factor = std::strtod(next.substr(0, 25).c_str(), nullptr);
  return factor > 0 && std::isfinite(factor) ? 1 / factor : 1;
}

}  // namespace

bool is_body_file(const std::filesystem::path& path) {
  const FileFormat* format = format_of(path);
  return format && format->is_body;
}

bool is_surface_file(const std::filesystem::path& path) {
  return is_of_kind(path, FileKind::surface) || is_of_kind(path, FileKind::gltf);
}

bool is_geometry_file(const std::filesystem::path& path) {
  return is_of_kind(path, FileKind::geometry) || is_of_kind(path, FileKind::program);
}

bool declares_mesh_size(const std::filesystem::path& path) {
  if (!is_of_kind(path, FileKind::program)) return false;
  const Result<std::string> text = read_whole_file(path, kMaxGeoBytes);
  return text && assigns(*text, kMeshSizeName);
}

double unit_in_file(const std::filesystem::path& path) {
  if (has_ending(path, ".unv")) return unit_of_unv(path);
  const FileFormat* format = format_of(path);
  return format ? format->unit_m : 1;
}

}  // namespace ringdown::mesh
