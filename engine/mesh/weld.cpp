#include "engine/mesh/surface_reader.h"

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace ringdown::mesh {
namespace {

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
