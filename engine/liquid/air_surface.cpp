#include "engine/liquid/air_surface.h"

#include "engine/radiate/mirror_part.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace ringdown::liquid {
namespace {

using Eigen::Vector2d;
using Loop = std::vector<int>;
using Triangle = std::array<int, 3>;

constexpr double kSampleSide = 0.06;  // of the square root of a free surface's area

double cross(const Vector2d& a, const Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }
double twice_area(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return cross(b - a, c - a); }

double area_of(const std::vector<Vector2d>& corners, const Loop& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) twice += cross(corners[loop[i]], corners[loop[(i + 1) % loop.size()]]);
  return twice / 2;
}

bool cross_each_other(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return twice_area(a, b, c) * twice_area(a, b, d) < 0 && twice_area(c, d, a) * twice_area(c, d, b) < 0;
}

bool is_inside(const std::vector<Vector2d>& corners, const Loop& loop, const Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector2d &a = corners[loop[i]], &b = corners[loop[(i + 1) % loop.size()]];
    if ((a[1] > point[1]) != (b[1] > point[1]) && point[0] < a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
      inside = !inside;
  }
  return inside;
}

// Joins a hole to the loop around it by a way there and back along the shortest line that crosses neither.
bool join(const std::vector<Vector2d>& corners, Loop& outer, const Loop& hole) {
  std::pair<std::size_t, std::size_t> best;
  double shortest = std::numeric_limits<double>::infinity();
  const auto crosses = [&](const Loop& loop, const Vector2d& a, const Vector2d& b) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (cross_each_other(a, b, corners[loop[i]], corners[loop[(i + 1) % loop.size()]])) return true;
    }
    return false;
  };
  for (std::size_t o = 0; o < outer.size(); ++o) {
    for (std::size_t h = 0; h < hole.size(); ++h) {
      const Vector2d &a = corners[outer[o]], &b = corners[hole[h]];
      if ((a - b).norm() >= shortest || crosses(outer, a, b) || crosses(hole, a, b)) continue;
      shortest = (a - b).norm();
      best = {o, h};
    }
  }
  if (!std::isfinite(shortest)) return false;
  Loop joined(outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(best.first) + 1);
  for (std::size_t i = 0; i <= hole.size(); ++i) joined.push_back(hole[(best.second + i) % hole.size()]);
  joined.insert(joined.end(), outer.begin() + static_cast<std::ptrdiff_t>(best.first), outer.end());
  outer = std::move(joined);
  return true;
}

// Cuts off ears, the one with the shortest new side first.
bool cut_ears(const std::vector<Vector2d>& corners, Loop loop, std::vector<Triangle>& triangles) {
  while (loop.size() >= 3) {
    std::size_t best = loop.size();
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int before = loop[(i + loop.size() - 1) % loop.size()], at = loop[i], after = loop[(i + 1) % loop.size()];
      const Vector2d &a = corners[before], &b = corners[at], &c = corners[after];
      const double side = (a - c).norm();
      if (side >= shortest || !(twice_area(a, b, c) > 1e-9 * side * side)) continue;
      const bool empty = std::ranges::none_of(loop, [&](int n) {
        if (n == before || n == at || n == after) return false;
        const Vector2d& p = corners[n];
        return twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
      });
      if (!empty) continue;
      shortest = side;
      best = i;
    }
    if (best == loop.size()) return false;
    triangles.push_back({loop[(best + loop.size() - 1) % loop.size()], loop[best], loop[(best + 1) % loop.size()]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return true;
}

// Adds samples of a triangle of the plane, divided until its sides are short.
void sample(const Vector2d& a, const Vector2d& b, const Vector2d& c, double side, std::vector<Vector2d>& at,
            std::vector<double>& areas) {
  const double ab = (a - b).norm(), bc = (b - c).norm(), ca = (c - a).norm();
  if (std::max({ab, bc, ca}) <= side) {
    for (const Vector2d& corner : {a, b, c}) {
      at.push_back(corner / 2 + (a + b + c) / 6);
      areas.push_back(std::abs(twice_area(a, b, c)) / 6);
    }
  } else if (ab >= bc && ab >= ca) {
    sample(a, (a + b) / 2, c, side, at, areas);
    sample((a + b) / 2, b, c, side, at, areas);
  } else if (bc >= ca) {
    sample(a, b, (b + c) / 2, side, at, areas);
    sample(a, (b + c) / 2, c, side, at, areas);
  } else {
    sample(a, b, (a + c) / 2, side, at, areas);
    sample((a + c) / 2, b, c, side, at, areas);
  }
}

// Half of the triangles on one side of the level, with the first coordinate pointing there. Both halves give the same
// numbers to the nodes on the level, because they are cut in the same order.
mesh::TriangleMesh half(const mesh::TriangleMesh& part, double direction) {
  mesh::TriangleMesh turned = part;
  turned.nodes.col(0) *= direction;
  mesh::TriangleMesh half = radiate::mirror_part_of(turned, 1);
  half.nodes.col(0) *= direction;
  return half;
}

// The sides of the wet half along the level, as loops along the run of its triangles: so a lid on the dry half runs.
// (Of a vessel that is full to the brim nothing of the dry half is left.)
std::vector<Loop> rims_of(const mesh::TriangleMesh& wet) {
  const std::vector<mesh::EdgeUse> all = mesh::edges_of(wet, std::vector<bool>(wet.triangles.rows(), true));
  std::vector<mesh::EdgeUse> rim;
  for (std::size_t i = 0; i < all.size(); i = mesh::end_of_edge(all, i)) {
    const bool single = mesh::end_of_edge(all, i) == i + 1;
    if (single && wet.nodes(all[i].low, 0) == 0 && wet.nodes(all[i].high, 0) == 0) rim.push_back(all[i]);
  }
  std::vector<Loop> loops;
  for (const auto& loop : mesh::loops_of(rim)) loops.emplace_back(loop.rbegin(), loop.rend());
  return loops;
}

class Builder {
 public:
  explicit Builder(const Skin& skin) : wet_(static_cast<std::size_t>(skin.at.rows()), false) {
    for (const auto& node : skin.surface.nodes.rowwise()) nodes_.emplace_back(node);
  }

  Result<FreeSurface> add(const Skin& skin, const Wetted& liquid) {
    for (const Eigen::Index s : liquid.samples) wet_[s] = true;
    FreeSurface free;
    if (!liquid.open) return free;
    mesh::TriangleMesh part;
    part.nodes = (skin.surface.nodes * liquid.turn.transpose()).rowwise() + liquid.shift.transpose();
    part.triangles.resize(static_cast<Eigen::Index>(liquid.triangles.size()), 3);
    for (std::size_t t = 0; t < liquid.triangles.size(); ++t)
      part.triangles.row(static_cast<Eigen::Index>(t)) = skin.surface.triangles.row(liquid.triangles[t]);
    const mesh::TriangleMesh dry = half(part, -1);
    const std::vector<Loop> loops = rims_of(half(part, 1));
    if (loops.empty() && liquid.outside) return free;  // it lies deep
    const std::vector<int> numbers = take_nodes(dry, part, liquid);
    for (const auto& triangle : dry.triangles.rowwise())
      triangles_.push_back({numbers[triangle[0]], numbers[triangle[1]], numbers[triangle[2]]});
    // Seen from where the lid's normal points, its loops run counter-clockwise.
    std::vector<Vector2d> corners;
    for (const auto& node : dry.nodes.rowwise())
      corners.push_back(liquid.outside ? Vector2d(node[1], node[2]) : Vector2d(node[2], node[1]));
    const std::vector<Triangle> lid = fill_loops(corners, loops);
    if (lid.empty())
      return fail(ErrorKind::bad_input,
                  "the line of the liquid's surface on the body crosses itself; change the level");
    for (const Triangle& t : lid) triangles_.push_back({numbers[t[0]], numbers[t[1]], numbers[t[2]]});
    if (!liquid.outside) sample_lid(corners, lid, free);
    return free;
  }

  AirSurface finish(const Skin& skin, const std::vector<Wetted>& liquids) {
    std::vector<bool> cut(static_cast<std::size_t>(skin.surface.triangles.rows()), false);
    for (const Wetted& liquid : liquids) {
      for (const Eigen::Index t : liquid.triangles) cut[t] = true;
    }
    for (Eigen::Index t = 0; t < skin.surface.triangles.rows(); ++t) {
      const auto row = skin.surface.triangles.row(t);
      if (!cut[t]) triangles_.push_back({row[0], row[1], row[2]});
    }
    AirSurface air;
    air.surface.nodes.resize(static_cast<Eigen::Index>(nodes_.size()), 3);
    for (std::size_t n = 0; n < nodes_.size(); ++n) air.surface.nodes.row(static_cast<Eigen::Index>(n)) = nodes_[n];
    air.surface.triangles.resize(static_cast<Eigen::Index>(triangles_.size()), 3);
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      air.surface.triangles.row(static_cast<Eigen::Index>(t)) << triangles_[t][0], triangles_[t][1], triangles_[t][2];
    mesh::drop_unused_nodes(air.surface);
    for (std::size_t s = 0; s < wet_.size(); ++s) {
      if (!wet_[s]) air.dry.push_back(static_cast<Eigen::Index>(s));
    }
    return air;
  }

 private:
  // Takes the places of the nodes, some of which were moved onto the level, and returns their numbers here.
  std::vector<int> take_nodes(const mesh::TriangleMesh& dry, const mesh::TriangleMesh& part, const Wetted& liquid) {
    const Eigen::Index old = part.nodes.rows();
    std::vector<bool> used(static_cast<std::size_t>(old), false);
    for (Eigen::Index i = 0; i < part.triangles.size(); ++i) used[part.triangles.data()[i]] = true;
    std::vector<int> numbers;
    for (Eigen::Index n = 0; n < dry.nodes.rows(); ++n) {
      const Eigen::RowVector3d place =
          (liquid.turn.transpose() * (dry.nodes.row(n).transpose() - liquid.shift)).transpose();
      if (n < old) {
        numbers.push_back(static_cast<int>(n));
        if (used[n] && dry.nodes(n, 0) != part.nodes(n, 0)) nodes_[n] = place;
      } else {
        numbers.push_back(static_cast<int>(nodes_.size()));
        nodes_.push_back(place);
      }
    }
    return numbers;
  }

  static void sample_lid(const std::vector<Vector2d>& corners, const std::vector<Triangle>& lid, FreeSurface& free) {
    double area = 0;
    for (const Triangle& t : lid) area += twice_area(corners[t[0]], corners[t[1]], corners[t[2]]) / 2;
    std::vector<Vector2d> at;
    std::vector<double> areas;
    for (const Triangle& t : lid)
      sample(corners[t[0]], corners[t[1]], corners[t[2]], kSampleSide * std::sqrt(area), at, areas);
    free.at.resize(static_cast<Eigen::Index>(at.size()), 3);
    free.areas = Eigen::Map<const Eigen::VectorXd>(areas.data(), static_cast<Eigen::Index>(areas.size()));
    for (std::size_t i = 0; i < at.size(); ++i) free.at.row(static_cast<Eigen::Index>(i)) << 0, at[i][1], at[i][0];
  }

  std::vector<bool> wet_;
  std::vector<Eigen::RowVector3d> nodes_;
  std::vector<Triangle> triangles_;
};

}  // namespace

std::vector<Triangle> fill_loops(const std::vector<Vector2d>& corners, const std::vector<Loop>& loops) {
  std::vector<Loop> outer;
  for (const Loop& loop : loops) {
    if (area_of(corners, loop) > 0) outer.push_back(loop);
  }
  for (const Loop& hole : loops) {
    if (area_of(corners, hole) > 0) continue;
    const auto around =
        std::ranges::find_if(outer, [&](const Loop& loop) { return is_inside(corners, loop, corners[hole.front()]); });
    if (around == outer.end() || !join(corners, *around, hole)) return {};
  }
  std::vector<Triangle> triangles;
  for (const Loop& loop : outer) {
    if (!cut_ears(corners, loop, triangles)) return {};
  }
  return triangles;
}

Result<AirSurface> air_surface_of(const Skin& skin, const std::vector<Wetted>& liquids) {
  Builder builder(skin);
  std::vector<FreeSurface> free;
  for (const Wetted& liquid : liquids) {
    Result<FreeSurface> one = builder.add(skin, liquid);
    if (!one) return fail(one);
    free.push_back(std::move(*one));
  }
  AirSurface air = builder.finish(skin, liquids);
  air.free = std::move(free);
  return air;
}

}  // namespace ringdown::liquid
