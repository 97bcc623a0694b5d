#include "engine/mesh/stuffing/stuffing.h"

#include "engine/base/in_parallel.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/mesh_joints.h"
#include "engine/mesh/stuffing/bcc_lattice.h"
#include "engine/mesh/stuffing/sharpen.h"
#include "engine/mesh/stuffing/winding_number.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

// Isosurface stuffing, step by step
//
// 1. find_sides(): every point of the lattice is inside or outside. The lattice is taken brick by brick; a brick
//    that no triangle comes near is decided as a whole, so the cost follows the surface, not the volume.
// 2. find_rim(): the points inside that have a neighbour outside.
// 3. find_cuts(): each edge from a rim point to a neighbour outside is cut where it leaves the body.
// 4. warp(): a lattice point with a cut point too near to it moves onto the nearest such cut point. The point is then
//    on the surface, and its edges no longer have cut points. This step bounds the angles.
// 5. fill(): the part of each tetrahedron of the lattice that is inside becomes elements (bcc_lattice.h). Points and
//    cut points become nodes when an element first needs them.
//
// Steps 1 and 3 compute winding numbers and take nearly all of the time; they are divided among threads. The remaining
// steps run on one thread in a fixed order, so the mesh does not depend on the number of threads.
namespace ringdown::mesh {
namespace {

using Eigen::Vector3d;
using Site = BccLattice::Site;

constexpr int kMargin = 2;  // number of cubes around the body's box
constexpr int kBrick = 4;   // number of cubes along the edge of a brick, which one thread processes at a time
constexpr int kBisections = 24;

double length_of(int direction) { return direction < BccLattice::kLongDirections ? 1 : std::sqrt(0.75); }
double near_of(int direction) { return direction < BccLattice::kLongDirections ? kNearLong : kNearShort; }

class TriangleSolid final : public Solid {
 public:
  TriangleSolid(const TriangleMesh& surface, const WindingNumber& winding) : winding_(winding) {
    low.setConstant(std::numeric_limits<double>::infinity());
    high = -low;
    for (const std::int32_t node : surface.triangles.reshaped()) {
      low = low.cwiseMin(surface.nodes.row(node).transpose());
      high = high.cwiseMax(surface.nodes.row(node).transpose());
    }
  }

  [[nodiscard]] bool inside(const Vector3d& point) const override { return winding_.inside(point); }

  // Between two crossings of triangles the winding number changes smoothly, and at a crossing it jumps. A jump from
  // inside to outside is found exactly; a smooth way out, through a hole, by bisection between the crossings.
  [[nodiscard]] double exit_fraction(const Vector3d& a, const Vector3d& b) const override {
    constexpr double kStep = 1e-7;
    double from = 0;
    for (const double crossing : winding_.crossings(a, b)) {
      if (crossing - kStep > from && !inside(a + (crossing - kStep) * (b - a))) {
        return bisect(a, b, from, crossing - kStep);
      }
      if (crossing + kStep >= 1 || !inside(a + (crossing + kStep) * (b - a))) return crossing;
      from = crossing + kStep;
    }
    return bisect(a, b, from, 1);
  }

  // Returns true if no triangle is near, and the winding number at the corners and in the middle is far from one half,
  // always above or always below. Without triangles the number is harmonic, so it does not reach one half in between.
  [[nodiscard]] bool uniform(const Vector3d& from, const Vector3d& to) const override {
    const Vector3d margin = (to - from) / 2;
    if (winding_.near(from - margin, to + margin)) return false;
    int inside = 0;
    for (int k = 0; k < 9; ++k) {
      Vector3d point = (from + to) / 2;
      for (int axis = 0; k < 8 && axis < 3; ++axis) point[axis] = k >> axis & 1 ? to[axis] : from[axis];
      const double number = winding_.at(point, 0.05);
      if (std::abs(number - 0.5) < 0.25) return false;
      inside += number > 0.5;
    }
    return inside == 0 || inside == 9;
  }

 private:
  [[nodiscard]] double bisect(const Vector3d& a, const Vector3d& b, double in, double out) const {
    for (int step = 0; step < kBisections && out - in > 1e-7; ++step) {
      const double middle = (in + out) / 2;
      (inside(a + middle * (b - a)) ? in : out) = middle;
    }
    return (in + out) / 2;
  }

  const WindingNumber& winding_;
};

class Stuffing {
 public:
  Stuffing(const Solid& solid, const BccLattice& lattice, int threads, const Progress& progress)
      : solid_(solid), lattice_(lattice), threads_(thread_count(threads)), progress_(progress) {}

  // Returns false if cancelled.
  bool run() {
    if (!find_sides()) return false;
    find_rim();
    if (!find_cuts()) return false;
    warp();
    fill();
    return true;
  }

  TetMesh take() { return std::move(mesh_); }

 private:
  // Calls work(i) once for each i < count, on all threads; progress goes from `from` to `to`.
  template <class Work>
  bool share(std::int64_t count, double from, double to, const Work& work) {
    std::atomic<std::int64_t> next = 0;
    std::atomic<bool> stopped = false;
    constexpr std::int64_t kBatch = 16;
    in_parallel(threads_, [&](int thread) {
      for (std::int64_t first; !stopped && (first = next.fetch_add(kBatch)) < count;) {
        for (std::int64_t i = first; i < std::min(first + kBatch, count); ++i) work(i);
        const double done = static_cast<double>(first) / static_cast<double>(count);
        if (thread == 0 && progress_ && !progress_("stuffing", from + (to - from) * done)) stopped = true;
      }
    });
    return !stopped;
  }

  // Returns true in the outermost half cube of the lattice's box, whose tetrahedra are incomplete. No point there may
  // be inside.
  [[nodiscard]] bool at_rim(const Site& site) const {
    return (site.array() <= 1).any() || (site.array() >= 2 * lattice_.cubes().array() - 1).any();
  }

  bool find_sides() {
    sides_.assign(lattice_.point_count(), Side::outside);
    const Eigen::Vector3i bricks = (lattice_.cubes().array() + kBrick) / kBrick;
    return share(bricks.cast<std::int64_t>().prod(), 0, 0.5, [&](std::int64_t brick) {
      const auto b = static_cast<int>(brick);
      const Site first = 2 * kBrick * Site(b % bricks[0], b / bricks[0] % bricks[1], b / bricks[0] / bricks[1]);
      const Site last = (first.array() + 2 * kBrick - 1).min(2 * lattice_.cubes().array());
      const Vector3d low = lattice_.point(first), high = lattice_.point(last);
      const bool uniform = solid_.uniform(low, high);
      const bool inside = uniform && solid_.inside((low + high) / 2);
      if (uniform && !inside) return;
      Site at;
      for (at[2] = first[2]; at[2] <= last[2]; ++at[2]) {
        for (at[1] = first[1] + (at[2] & 1); at[1] <= last[1]; at[1] += 2) {
          for (at[0] = first[0] + (at[2] & 1); at[0] <= last[0]; at[0] += 2) {
            if (at_rim(at)) continue;
            if (inside || solid_.inside(lattice_.point(at))) sides_[lattice_.number(at)] = Side::inside;
          }
        }
      }
    });
  }

  void find_rim() {
    rim_number_.assign(sides_.size(), -1);
    for (std::int32_t point = 0; point < lattice_.point_count(); ++point) {
      if (sides_[point] != Side::inside) continue;
      const Site site = lattice_.site(point);
      for (int direction = 0; direction < BccLattice::kDirections; ++direction) {
        if (side(site + BccLattice::direction(direction)) != Side::outside) continue;
        rim_number_[point] = static_cast<std::int32_t>(rim_.size());
        rim_.push_back(point);
        break;
      }
    }
  }

  bool find_cuts() {
    cuts_.assign(rim_.size(), {});
    return share(static_cast<std::int64_t>(rim_.size()), 0.5, 1, [&](std::int64_t rim) {
      const Site site = lattice_.site(rim_[rim]);
      for (int direction = 0; direction < BccLattice::kDirections; ++direction) {
        const Site other = site + BccLattice::direction(direction);
        if (side(other) == Side::outside) {
          cuts_[rim][direction] = solid_.exit_fraction(lattice_.point(site), lattice_.point(other));
        }
      }
    });
  }

  [[nodiscard]] Side side(const Site& site) const { return sides_[lattice_.number(site)]; }

  [[nodiscard]] Vector3d cut_point(std::int32_t rim, int direction) const {
    const Site site = lattice_.site(rim_[rim]);
    const Vector3d from = lattice_.point(site), to = lattice_.point(site + BccLattice::direction(direction));
    return from + cuts_[rim][direction] * (to - from);
  }

  // All points with cut points on their edges, ascending.
  [[nodiscard]] std::vector<std::int32_t> ends_of_cuts() const {
    std::vector<std::int32_t> ends = rim_;
    for (const std::int32_t rim : rim_) {
      const Site site = lattice_.site(rim);
      for (int direction = 0; direction < BccLattice::kDirections; ++direction) {
        const std::int32_t other = lattice_.number(site + BccLattice::direction(direction));
        if (sides_[other] == Side::outside) ends.push_back(other);
      }
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
  }

  // Visits the ends of cut edges in the order of their numbers. `share` is the distance of the cut point from this end
  // as a fraction of the edge. An edge whose opposite end is already on the surface is no longer cut.
  void warp() {
    node_of_.assign(sides_.size(), -1);
    for (const std::int32_t point : ends_of_cuts()) {
      const Site site = lattice_.site(point);
      double nearest = std::numeric_limits<double>::infinity();
      Vector3d target;
      for (int direction = 0; direction < BccLattice::kDirections; ++direction) {
        if (!lattice_.has(site + BccLattice::direction(direction))) continue;
        const std::int32_t other = lattice_.number(site + BccLattice::direction(direction));
        if (static_cast<int>(sides_[point]) * static_cast<int>(sides_[other]) >= 0) continue;
        const bool is_inside = sides_[point] == Side::inside;
        const std::int32_t rim = rim_number_[is_inside ? point : other];
        const double cut = cuts_[rim][is_inside ? direction : direction ^ 1], share = is_inside ? cut : 1 - cut;
        if (share >= near_of(direction) || share * length_of(direction) >= nearest) continue;
        nearest = share * length_of(direction);
        target = cut_point(rim, is_inside ? direction : direction ^ 1);
      }
      if (!std::isfinite(nearest)) continue;
      sides_[point] = Side::surface;
      node_of_[point] = add_node(target);
    }
  }

  std::int32_t add_node(const Vector3d& at) {
    nodes_.push_back(at);
    return static_cast<std::int32_t>(nodes_.size() - 1);
  }

  std::int32_t node(const std::array<Site, 4>& sites, StencilPoint which) {
    const Site& site = sites[which.a];
    const std::int32_t point = lattice_.number(site);
    if (which.a == which.b) {
      if (node_of_[point] < 0) node_of_[point] = add_node(lattice_.point(site));
      return node_of_[point];
    }
    const std::int32_t rim = rim_number_[point];
    int direction = 0;
    while (BccLattice::direction(direction) != sites[which.b] - site) ++direction;
    std::int32_t& known = cut_node_[rim][direction];
    if (known < 0) known = add_node(cut_point(rim, direction));
    return known;
  }

  void fill() {
    std::array<std::int32_t, BccLattice::kDirections> none;
    none.fill(-1);
    cut_node_.assign(rim_.size(), none);
    for (std::int32_t point = lattice_.corner_count(); point < lattice_.point_count(); ++point) {
      const Site centre = lattice_.site(point);
      if ((centre.array() >= 2 * lattice_.cubes().array() - 1).any()) continue;
      for (int number = 0; number < 12; ++number) {
        const std::array<Site, 4> sites = BccLattice::tetrahedron(centre, number);
        std::array<Side, 4> sides;
        for (int c = 0; c < 4; ++c) sides[c] = side(sites[c]);
        if (std::find(sides.begin(), sides.end(), Side::inside) == sides.end()) continue;
        const Stencil parts = stencil(sites, sides);
        for (int e = 0; e < parts.count; ++e) add_element(sites, parts.elements[e]);
      }
    }
    finish();
  }

  void add_element(const std::array<Site, 4>& sites, const std::array<StencilPoint, 4>& points) {
    std::array<std::int32_t, 4> element;
    for (int c = 0; c < 4; ++c) element[c] = node(sites, points[c]);
    Eigen::Matrix3d edges;
    for (int c = 0; c < 3; ++c) edges.row(c) = nodes_[element[c + 1]] - nodes_[element[0]];
    if (edges.determinant() < 0) std::swap(element[2], element[3]);
    elements_.push_back(element);
  }

  void finish() {
    mesh_.nodes.resize(static_cast<Eigen::Index>(nodes_.size()), 3);
    for (std::size_t n = 0; n < nodes_.size(); ++n) mesh_.nodes.row(n) = nodes_[n];
    mesh_.elements.resize(static_cast<Eigen::Index>(elements_.size()), 4);
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      for (int c = 0; c < 4; ++c) mesh_.elements(e, c) = elements_[e][c];
    }
  }

  const Solid& solid_;
  BccLattice lattice_;
  int threads_;
  const Progress& progress_;
  std::vector<Side> sides_;
  std::vector<std::int32_t> rim_;                                  // points inside with a neighbour outside
  std::vector<std::int32_t> rim_number_, node_of_;                 // per point; -1: none
  std::vector<std::array<double, BccLattice::kDirections>> cuts_;  // per rim point, fraction of each edge inside
  std::vector<std::array<std::int32_t, BccLattice::kDirections>> cut_node_;
  std::vector<Vector3d> nodes_;
  std::vector<std::array<std::int32_t, 4>> elements_;
  TetMesh mesh_;
};

}  // namespace

double Solid::exit_fraction(const Vector3d& a, const Vector3d& b) const {
  double in = 0, out = 1;
  for (int step = 0; step < kBisections; ++step) {
    const double middle = (in + out) / 2;
    (inside(a + middle * (b - a)) ? in : out) = middle;
  }
  return (in + out) / 2;
}

Result<Stuffed> stuff(const Solid& solid, const StuffOptions& options, const Progress& progress) {
  const double size = options.size_m;
  if (!(size > 0) || !std::isfinite(size)) return fail(ErrorKind::bad_input, "stuffing needs a mesh size above zero");
  const Vector3d extent = solid.high - solid.low;
  if (!extent.allFinite() || extent.minCoeff() < 0)
    return fail(ErrorKind::bad_input, "the surface has no triangles, so nothing is inside");
  const Vector3d cubes = (extent / size).array().ceil() + 2 * kMargin;
  const double points = 2 * cubes.prod();
  if (!(points < kMaxLatticePoints)) {
    return fail(ErrorKind::too_large,
                "a mesh size of {:.3g} mm would need a lattice of {:.2g} million points, above 30 million; {:.3g} mm "
                "is the finest that fits",
                size * 1e3, points / 1e6, 1.05 * size * std::cbrt(points / kMaxLatticePoints) * 1e3);
  }
  const Vector3d origin = (solid.low + solid.high - size * cubes) / 2;
  Stuffing stuffing(solid, BccLattice(origin, size, cubes.cast<int>()), options.threads, progress);
  if (!stuffing.run()) return fail_cancelled();
  Stuffed stuffed;
  stuffed.mesh = stuffing.take();
  const Trimmed trimmed = keep_sound_parts(stuffed.mesh, kCrumb);
  stuffed.crumbs = trimmed.crumbs;
  stuffed.hinges = trimmed.hinges;
  if (stuffed.mesh.elements.rows() == 0) {
    return fail(ErrorKind::bad_input,
                "a mesh size of {:.3g} mm finds nothing inside the surface: it is open, or its walls are thinner; "
                "close it, or choose a smaller mesh size",
                size * 1e3);
  }
  return stuffed;
}

Result<Stuffed> stuff(const TriangleMesh& surface, const StuffOptions& options, const Progress& progress) {
  if (!surface.nodes.allFinite()) return fail(ErrorKind::bad_input, "the surface has coordinates that are not numbers");
  const WindingNumber winding(surface);
  auto stuffed = stuff(TriangleSolid(surface, winding), options, progress);
  if (!stuffed) return stuffed;
  stuffed->turned = winding.turned();
  if (!options.sharpen) return stuffed;
  TetMesh sharp = stuffed->mesh;
  stuffed->sharpened = sharpen(sharp, winding, options.size_m);
  if (stuffed->sharpened > 0 && check_overlap(sharp, "")) stuffed->mesh = std::move(sharp);
  return stuffed;
}

}  // namespace ringdown::mesh
