#include "engine/liquid/wet_wall.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <utility>

namespace ringdown::liquid {
namespace {

constexpr int kScannedLevels = 128;
constexpr double kMinBasin = 1e-3;  // of the largest basin's volume
constexpr double kRimBisections = 40;

using Corners = std::array<Eigen::Vector3d, 3>;

// The sums over the part of a triangle below the level: its area, its vector area along `up`, and the liquid over it.
struct Below {
  double area = 0, opening = 0, volume = 0;
};

Below below(const Corners& corners, const std::array<double, 3>& depth, const Eigen::Vector3d& up) {
  std::array<Eigen::Vector3d, 4> polygon;
  std::array<double, 4> depths{};
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if (depth[i] >= 0) {
      polygon[count] = corners[i];
      depths[count++] = depth[i];
    }
    if (depth[i] * depth[next] < 0) {
      polygon[count] = corners[i] + depth[i] / (depth[i] - depth[next]) * (corners[next] - corners[i]);
      depths[count++] = 0;
    }
  }
  Below sum;
  for (int i = 2; i < count; ++i) {
    const Eigen::Vector3d twice = (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
    const double along = 0.5 * twice.dot(up);
    sum.area += 0.5 * twice.norm();
    sum.opening += along;
    sum.volume += along * (depths[0] + depths[i - 1] + depths[i]) / 3;
  }
  return sum;
}

// Numbers that stand for sets, joined step by step.
class Sets {
 public:
  explicit Sets(Eigen::Index count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void join(int a, int b) { parent_[find(a)] = find(b); }

 private:
  std::vector<int> parent_;
};

const Piece* basin_with(const std::vector<Piece>& pieces, int bottom) {
  const auto found =
      std::ranges::find_if(pieces, [&](const Piece& piece) { return piece.is_basin() && piece.lowest == bottom; });
  return found == pieces.end() ? nullptr : &*found;
}

std::string in_metres(double value, double metre) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g m", value / metre);
  return text;
}

}  // namespace

Skin flat_skin(mesh::TriangleMesh surface) {
  Skin skin;
  const Eigen::Index triangles = surface.triangles.rows();
  skin.samples.normals.resize(3 * triangles, 3);
  skin.samples.areas.resize(3 * triangles);
  std::vector<Eigen::Triplet<double>> weights;
  for (Eigen::Index t = 0; t < triangles; ++t) {
    Corners at;
    for (int i = 0; i < 3; ++i) at[i] = surface.nodes.row(surface.triangles(t, i)).transpose();
    const Eigen::Vector3d twice = (at[1] - at[0]).cross(at[2] - at[0]);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Index sample = 3 * t + i;
      skin.samples.normals.row(sample) = twice.normalized().transpose();
      skin.samples.areas[sample] = twice.norm() / 6;
      for (int j = 0; j < 3; ++j)
        weights.emplace_back(static_cast<int>(sample), surface.triangles(t, j), i == j ? 2 / 3.0 : 1 / 6.0);
    }
  }
  skin.samples.interpolation.resize(3 * triangles, surface.nodes.rows());
  skin.samples.interpolation.setFromTriplets(weights.begin(), weights.end());
  skin.at = skin.samples.interpolation * surface.nodes;
  skin.surface = std::move(surface);
  return skin;
}

Skin skin_of(const mesh::TetMesh& mesh, const mesh::Boundary& boundary) {
  Skin skin;
  skin.surface.nodes.resize(static_cast<Eigen::Index>(boundary.nodes.size()), 3);
  for (std::size_t n = 0; n < boundary.nodes.size(); ++n)
    skin.surface.nodes.row(static_cast<Eigen::Index>(n)) = mesh.nodes.row(boundary.nodes[n]);
  skin.surface.triangles.resize(static_cast<Eigen::Index>(boundary.triangles.size()), 3);
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i)
      skin.surface.triangles(static_cast<Eigen::Index>(t), i) = static_cast<std::int32_t>(boundary.triangles[t][i]);
  }
  skin.samples = mesh::flow_quadrature_of(boundary, mesh);
  skin.at = skin.samples.interpolation * skin.surface.nodes;
  return skin;
}

WetWall::WetWall(const Skin& skin, const Eigen::Vector3d& up)
    : skin_(skin), up_(up.normalized()), heights_(skin.surface.nodes * up_) {}

// The part of a triangle below a level is convex, so two nodes below it that share a triangle lie in one piece.
std::vector<Piece> WetWall::pieces_below(double level) const {
  const mesh::TriangleMesh& surface = skin_.surface;
  Sets sets(surface.nodes.rows());
  const auto lowest_corner = [&](Eigen::Index t) {
    int lowest = surface.triangles(t, 0);
    for (int i = 1; i < 3; ++i) {
      const int node = surface.triangles(t, i);
      if (std::pair(heights_[node], node) < std::pair(heights_[lowest], lowest)) lowest = node;
    }
    return lowest;
  };
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const int lowest = lowest_corner(t);
    for (int i = 0; i < 3; ++i) {
      if (heights_[surface.triangles(t, i)] < level) sets.join(surface.triangles(t, i), lowest);
    }
  }
  std::vector<Piece> pieces;
  std::map<int, std::size_t> number;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const int lowest = lowest_corner(t);
    if (!(heights_[lowest] < level)) continue;
    const auto [found, fresh] = number.emplace(sets.find(lowest), pieces.size());
    if (fresh) pieces.emplace_back().lowest = lowest;
    Piece& piece = pieces[found->second];
    piece.triangles.push_back(t);
    if (std::pair(heights_[lowest], lowest) < std::pair(heights_[piece.lowest], piece.lowest)) piece.lowest = lowest;
    Corners at;
    std::array<double, 3> depth{};
    for (int i = 0; i < 3; ++i) {
      at[i] = surface.nodes.row(surface.triangles(t, i)).transpose();
      depth[i] = level - heights_[surface.triangles(t, i)];
    }
    const Below sum = below(at, depth, up_);
    piece.area += sum.area;
    piece.opening += sum.opening;
    piece.volume += sum.volume;
  }
  return pieces;
}

std::vector<Basin> basins_of(const WetWall& wall) {
  const double low = wall.lowest(), step = (wall.highest() - low) / kScannedLevels;
  std::map<int, double> held;  // bottom -> the highest scanned level that its basin holds
  for (int i = 1; i <= kScannedLevels; ++i) {
    const double level = low + (i - 0.5) * step;
    for (const Piece& piece : wall.pieces_below(level)) {
      if (piece.is_basin() && !piece.is_closed()) held[piece.lowest] = level;
    }
  }
  std::vector<Basin> basins;
  for (const auto& [bottom, level] : held) {
    double yes = level, no = level + step;
    for (int i = 0; i < kRimBisections; ++i) {
      const double middle = (yes + no) / 2;
      const std::vector<Piece> pieces = wall.pieces_below(middle);
      const Piece* const piece = basin_with(pieces, bottom);
      (piece != nullptr && !piece->is_closed() ? yes : no) = middle;
    }
    basins.push_back({.bottom = bottom, .rim = yes, .volume = piece_of(wall, {.bottom = bottom}, yes).volume});
  }
  for (const Piece& piece : wall.pieces_below(wall.highest() + step)) {
    if (!piece.is_basin()) continue;  // a closed cavity
    const auto known = std::ranges::find(basins, piece.lowest, &Basin::bottom);
    if (known != basins.end()) basins.erase(known);
    double rim = wall.height(piece.lowest);
    for (const Eigen::Index t : piece.triangles) {
      for (const int node : wall.skin().surface.triangles.row(t)) rim = std::max(rim, wall.height(node));
    }
    basins.push_back({.bottom = piece.lowest, .rim = rim, .volume = piece.volume});
  }
  std::ranges::sort(basins, [](const Basin& a, const Basin& b) { return a.volume > b.volume; });
  std::erase_if(basins, [largest = basins.empty() ? 0 : basins.front().volume](const Basin& basin) {
    return basin.volume < kMinBasin * largest;
  });
  return basins;
}

Piece piece_of(const WetWall& wall, const Basin& basin, double level) {
  const std::vector<Piece> pieces = wall.pieces_below(level);
  const Piece* const piece = basin_with(pieces, basin.bottom);
  return piece != nullptr ? *piece : Piece{};
}

Result<double> level_of(const WetWall& wall, const Basin& basin, const Amount& amount, double metre) {
  const double bottom = wall.height(basin.bottom);
  const auto outside = [&](const std::string& what, const char* where) {
    return fail(ErrorKind::bad_input, what + " lies " + where + ": the basin reaches from " + in_metres(bottom, metre) +
                                          " to its rim at " + in_metres(basin.rim, metre) + " and holds " +
                                          std::to_string(std::lround(basin.volume / (metre * metre * metre) * 1e6)) +
                                          " ml");
  };
  double level = basin.rim;
  switch (amount.kind) {
    case Amount::Kind::kFull:
      return level;
    case Amount::Kind::kLevel:
      level = amount.value;
      break;
    case Amount::Kind::kDepth:
      level = bottom + amount.value;
      break;
    case Amount::Kind::kVolume: {
      if (amount.value > basin.volume) return outside("the volume of the liquid", "above the rim, and it spills");
      double low = bottom, high = basin.rim;
      for (int i = 0; i < 50; ++i) {
        const double middle = (low + high) / 2;
        (piece_of(wall, basin, middle).volume < amount.value ? low : high) = middle;
      }
      return high;
    }
  }
  if (!(level > bottom)) return outside("the level of " + in_metres(level, metre), "below the bottom");
  if (level > basin.rim + 1e-6 * (basin.rim - bottom))
    return outside("the level of " + in_metres(level, metre), "above the rim, and the liquid spills");
  return std::min(level, basin.rim);
}

}  // namespace ringdown::liquid
