#include "engine/mesh/file_kinds.h"

#include "engine/base/atomic_file.h"
#include "engine/mesh/geo_language.h"

#include <algorithm>
#include <array>
#include <cctype>
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

constexpr std::array kSurfaces = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb"};
constexpr std::array kGeometries = {".geo", ".step", ".stp", ".brep", ".iges", ".igs", ".xao"};

// In small letters.
std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

template <std::size_t N>
bool is_among(const std::string& ending, const std::array<const char*, N>& endings) {
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace

bool is_body_file(const std::filesystem::path& path) {
  constexpr std::array kMeshes = {".msh", ".vtk", ".inp", ".unv", ".mesh", ".bdf", ".node", ".veg", ".tet"};
  const std::string ending = ending_of(path);
  return is_among(ending, kMeshes) || is_among(ending, kGeometries) ||
         (is_among(ending, kSurfaces) && ending != ".glb");
}

bool is_surface_file(const std::filesystem::path& path) { return is_among(ending_of(path), kSurfaces); }

bool is_geometry_file(const std::filesystem::path& path) { return is_among(path.extension().string(), kGeometries); }

bool names_mesh_size(const std::filesystem::path& path) {
  if (path.extension() != ".geo") return false;
  const Result<std::string> text = read_whole_file(path, kMaxGeoBytes);
  return text && assigns(*text, "mesh_size");
}

double unit_in_file(const std::filesystem::path& path) {
  constexpr std::array kInMillimetres = {".step", ".stp", ".iges", ".igs"};
  const bool known = std::find(kInMillimetres.begin(), kInMillimetres.end(), path.extension()) != kInMillimetres.end();
  if (known) return 0.001;
  return path.extension() == ".unv" ? unit_of_unv(path) : 1;
}

}  // namespace ringdown::mesh
