#include "engine/mesh/files/surface_file.h"

#include "engine/base/atomic_file.h"
#include "engine/base/file_format.h"
#include "engine/mesh/files/gltf_mesh.h"
#include "engine/mesh/files/surface_formats.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

Result<TriangleSoup> read_soup(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return fail(ErrorKind::bad_input, "cannot open " + path.string() + ": there is no such file");
  const Result<std::string> content = read_whole_file(path, kMaxSurfaceFileBytes);
  if (!content) return fail(content);
  if (is_of_kind(path, FileKind::gltf)) return read_gltf_mesh(*content, path, kMaxTriangles);
  for (const SurfaceReader& reader : kSurfaceReaders) {
    if (has_ending(path, reader.ending)) return reader.read(*content, path.string());
  }
  return fail(ErrorKind::bad_input, path.string() + " is not a surface file");
}

TriangleMesh mesh_of(const TriangleSoup& soup) {
  TriangleMesh mesh;
  mesh.nodes.resize(static_cast<Eigen::Index>(soup.points.size()), 3);
  mesh.triangles.resize(static_cast<Eigen::Index>(soup.triangles.size()), 3);
  for (std::size_t i = 0; i < soup.points.size(); ++i) mesh.nodes.row(static_cast<Eigen::Index>(i)) = soup.points[i];
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) mesh.triangles(static_cast<Eigen::Index>(t), i) = soup.triangles[t][i];
  }
  return mesh;
}

// Rounding moves a face by up to half of the spacing of numbers, and with it as much volume as that times its area. A
// note says so where that is more than a thousandth of the volume.
std::string note_of_rounding(const decltype(TriangleMesh::nodes)& nodes, const Triangles& triangles, double rounding) {
  constexpr double kMaxShare = 1e-3;
  const Eigen::RowVector3d origin = nodes.row(triangles(0, 0));
  double area = 0, volume = 0;
  for (const auto& row : triangles.rowwise()) {
    const Eigen::RowVector3d a = nodes.row(row[0]) - origin, b = nodes.row(row[1]) - origin,
                             c = nodes.row(row[2]) - origin;
    area += 0.5 * (b - a).cross(c - a).norm();
    volume += a.dot(b.cross(c)) / 6;
  }
  const double share = 0.5 * rounding * area / std::abs(volume);
  if (!(share > kMaxShare) || !std::isfinite(share)) return "";
  return formatted(
      "its coordinates reach {:.3g}, where 32-bit floats lie {:.2g} apart, so that its volume may be wrong by up to "
      "{:.2g} %; move it to the origin before it is exported",
      nodes.cwiseAbs().maxCoeff(), rounding, 100 * share);
}

}  // namespace

Result<TriangleMesh> read_surface(const std::filesystem::path& path, std::vector<std::string>* notes) {
  const std::string name = path.string();
  const Result<TriangleSoup> soup = read_soup(path);
  if (!soup) return fail(soup);
  if (soup->triangles.empty()) return fail(ErrorKind::bad_input, name + " has no triangles; a body needs a surface");
  if (soup->triangles.size() > kMaxTriangles) {
    return fail(ErrorKind::too_large, "{} has more than {} triangles; simplify it in a mesh tool first", name,
                kMaxTriangles);
  }
  const TriangleMesh mesh = mesh_of(*soup);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i) {
      if (mesh.nodes.row(mesh.triangles(t, i)).allFinite()) continue;
      return fail(ErrorKind::bad_input, "{}: a corner of triangle {} is not a finite number", name, t);
    }
  }
  const double length = diagonal_of(mesh);
  if (!(length > 0)) return fail(ErrorKind::bad_input, name + ": all its points coincide; a body needs a surface");
  TriangleMesh welded = weld(mesh, kWeld * length);
  if (notes) {
    *notes = soup->notes;
    if (std::string note = note_of_rounding(welded.nodes, welded.triangles, soup->rounding); !note.empty())
      notes->push_back(std::move(note));
  }
  return welded;
}

namespace {

// Welding
//
// Points are taken in the order in which triangles name them. Each is looked up among the points kept so far; when one
// of them lies within the tolerance, the point becomes that one, otherwise it is kept. Kept points lie in the cells of
// a hash grid. A cell is 64 tolerances wide, so that a ball of one tolerance mostly lies in one cell and rarely touches
// eight; looking up a point costs a constant, and welding O(V).
using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15;
    for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0xff51afd7ed558ccd + (hash >> 29);
    return hash;
  }
};

// Points in cells much larger than the tolerance: most need to look into one only.
class PointGrid {
 public:
  explicit PointGrid(double tolerance) : tolerance_(tolerance), cell_(64 * tolerance) {}

  // The number of a point within the tolerance; else `number`, which is then in the grid.
  std::int32_t find_or_add(const Eigen::RowVector3d& at, std::int32_t number) {
    Cell low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = cell_of(at[axis] - tolerance_);
      high[axis] = cell_of(at[axis] + tolerance_);
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const auto& [other, place] : found->second) {
            if ((place - at).norm() <= tolerance_) return other;
          }
        }
      }
    }
    cells_[{cell_of(at[0]), cell_of(at[1]), cell_of(at[2])}].push_back({number, at});
    return number;
  }

 private:
  struct Entry {
    std::int32_t number;
    Eigen::RowVector3d at;
  };
  [[nodiscard]] std::int64_t cell_of(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }

  double tolerance_, cell_;
  std::unordered_map<Cell, std::vector<Entry>, CellHash> cells_;
};

}  // namespace

TriangleMesh weld(const TriangleMesh& mesh, double tolerance) {
  PointGrid grid(tolerance);
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.nodes.rows()), -1);
  std::vector<Eigen::RowVector3d> kept;
  TriangleMesh welded{.nodes = {}, .triangles = mesh.triangles};
  for (std::int32_t& corner : welded.triangles.reshaped<Eigen::RowMajor>()) {
    std::int32_t& known = number[static_cast<std::size_t>(corner)];
    if (known < 0) {
      const Eigen::RowVector3d at = mesh.nodes.row(corner);
      const auto next = static_cast<std::int32_t>(kept.size());
      known = grid.find_or_add(at, next);
      if (known == next) kept.push_back(at);
    }
    corner = known;
  }
  welded.nodes.resize(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) welded.nodes.row(static_cast<Eigen::Index>(i)) = kept[i];
  return welded;
}

}  // namespace ringdown::mesh
