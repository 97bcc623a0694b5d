#include "engine/mesh/stuffing/stuffed_body.h"

#include "engine/mesh/boundary.h"
#include "engine/mesh/mesh_check.h"
#include "engine/mesh/stuffing/stuffing.h"
#include "engine/mesh/stuffing/winding_number.h"
#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/surface_distance.h"
#include "engine/mesh/surface/surface_gap.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

// Two ways to a body
//
// Small cells follow thin walls, but a lattice of small cells is too large to solve. So only the lattice's skin is
// kept, which is sound whatever the surface was, and gmsh fills the skin with elements as large as the band allows
// (fill.h). For this purpose a lattice may have kMaxSkinElements. If gmsh cannot fill the skin, the body is a lattice
// of fewer, larger cells.
namespace ringdown::mesh {
namespace {

constexpr double kCellsPerWall = 2;
constexpr double kSkinCells = 60;  // minimum number of cells along the diagonal, so that the skin follows the shape
constexpr double kElementsPerCell = 12;  // elements of the lattice per cell
constexpr double kMaxSkinElements = 3e6, kMaxSolvedElements = 40e3;
constexpr double kMinKept = 0.5, kSmallerCells = 0.75, kMaxForcedElements = 2 * kMaxSolvedElements;
constexpr double kVanishing = 0.6;  // share of a cell; of oblique plates that are thinner, at most a seventh is left

struct Cells {
  double wanted_m = 0, size_m = 0;  // size_m is larger than wanted_m if there would be too many cells
};

class StuffedBody {
 public:
  StuffedBody(const TriangleMesh& surface, const FillOptions& options, bool force, const std::string& name,
              const Progress& progress)
      : surface_(surface), options_(options), force_(force), name_(name), progress_(progress) {
    box_ = surface.nodes.colwise().maxCoeff() - surface.nodes.colwise().minCoeff();
    volume_m3_ = std::abs(diagnose(surface).volume_m3);
    wall_m_ = wall_of_soup(surface);
    if (!(options_.size_m > 0)) options_.size_m = box_.norm() / 20;
    options_.wall_m = wall_m_;
  }

  Result<Body> run() {
    Result<Body> refilled = refill();
    if (refilled || refilled.error().kind == ErrorKind::cancelled) return refilled;
    if (refilled.error().kind == ErrorKind::too_large) return refilled;
    Cells cells = cells_for(options_.size_m, kMaxSolvedElements);
    if (auto fine = check_walls(cells, kMaxSolvedElements); !fine) return fail(fine);
    const Result<Stuffed> stuffed = stuff_thin(cells);
    if (!stuffed) return fail(stuffed.error().kind, name_ + " cannot be stuffed: " + stuffed.error().message);
    Result<CheckedMesh> checked = check_mesh(stuffed->mesh, name_);
    if (!checked) return fail(checked);
    Body body{.mesh = std::move(*checked), .making = Making::kStuffed, .notes = {}};
    body.mesh.gaps_m = surface_gaps(body.mesh.mesh, surface_, cells.size_m, true);
    body.notes.push_back("its skin was not filled by gmsh: " + refilled.error().message);
    tell(body, "stuffed", cells, stuffed->crumbs);
    return body;
  }

 private:
  [[nodiscard]] Cells cells_for(double largest_m, double max_elements) const {
    Cells cells;
    cells.wanted_m = wall_m_ > 0 ? std::min(largest_m, wall_m_ / kCellsPerWall) : largest_m;
    cells.size_m = std::max(cells.wanted_m, finest_m(max_elements));
    return cells;
  }

  [[nodiscard]] double finest_m(double max_elements) const {
    const double points = 2 * box_.prod() / (0.8 * kMaxLatticePoints);
    return std::max(std::cbrt(kElementsPerCell * volume_m3_ / max_elements), std::cbrt(points));
  }

  // Returns the finest cell size with force_coarse. With finer cells, half of the body would have too many elements.
  [[nodiscard]] double finest_forced_m() const { return finest_m(kMaxForcedElements / kMinKept); }

  [[nodiscard]] Result<void> check_walls(const Cells& cells, double max_elements) const {
    if (!(wall_m_ > 0) || cells.size_m <= wall_m_) return {};
    const bool vanish = wall_m_ < kVanishing * finest_forced_m();
    if (force_ && !vanish) return {};
    const double elements = kElementsPerCell * volume_m3_ / std::pow(cells.wanted_m, 3);
    return fail(ErrorKind::too_large,
                "{} has walls of {:.3g} mm, which cells of {:.3g} mm would follow: about {:.1e} elements, more than "
                "{:.0e}; the finest possible cells, {:.3g} mm, would tear them. Mend the faults that `ringdown check "
                "mesh` lists, so that gmsh can fill it{}",
                name_, 1000 * wall_m_, 1000 * cells.wanted_m, elements, max_elements, 1000 * cells.size_m,
                vanish ? "; with --force-coarse nothing would be left of such walls"
                       : ", or accept a wrong sound with --force-coarse");
  }

  // Stuffs a body whose walls are thinner than a cell, which is done only with force_coarse. Most or all of such a wall
  // falls between the lattice's points and vanishes, so the cells, and cells.size_m, become smaller until half of the
  // body is there.
  Result<Stuffed> stuff_thin(Cells& cells) const {
    const double finest = std::max(cells.wanted_m, finest_forced_m());
    if (force_ && wall_m_ > 0) cells.size_m = std::clamp(wall_m_ / kVanishing, finest, std::max(finest, cells.size_m));
    Result<Stuffed> stuffed = stuff(surface_, {.size_m = cells.size_m}, progress_);
    const auto is_enough = [this](const Result<Stuffed>& made) {
      return made ? volume_of(made->mesh) >= kMinKept * volume_m3_ : made.error().kind == ErrorKind::cancelled;
    };
    for (double size_m = cells.size_m; force_ && !is_enough(stuffed) && size_m > finest;) {
      size_m = std::max(kSmallerCells * size_m, finest);
      Result<Stuffed> next = stuff(surface_, {.size_m = size_m}, progress_);
      const bool too_many = next && static_cast<double>(next->mesh.elements.rows()) > kMaxForcedElements;
      if (stuffed && (!next || too_many)) break;
      if (next) cells.size_m = size_m;
      stuffed = std::move(next);
    }
    return stuffed;
  }

  // CGAL fails on some skins because of rounding. A second attempt uses smaller cells, which give another skin.
  Result<Body> refill() {
    const double size_m = std::min(options_.size_m, box_.norm() / kSkinCells);
    Result<Body> body = refill_by(size_m);
    if (!body && body.error().kind == ErrorKind::bad_input) body = refill_by(kSmallerCells * size_m);
    return body;
  }

  Result<Body> refill_by(double largest_m) {
    const Cells cells = cells_for(largest_m, kMaxSkinElements);
    if (auto fine = check_walls(cells, kMaxSkinElements); !fine) return fail(fine);
    if (wall_m_ > 0 && cells.size_m > wall_m_)
      return fail(ErrorKind::bad_input, "the finest possible cells would tear its walls");
    Result<Stuffed> stuffed = stuff(surface_, {.size_m = cells.size_m}, progress_);
    if (!stuffed) return fail(stuffed.error().kind, name_ + " cannot be stuffed: " + stuffed.error().message);
    const TriangleMesh skin = skin_of(stuffed->mesh);
    if (!diagnose(skin).sound()) return fail(ErrorKind::bad_input, "it has faults");
    Result<Filled> filled = fill(skin, options_, name_);
    if (!filled) return fail(filled);
    // A note means that gmsh used the skin's own small triangles, which give too many elements.
    if (!filled->note.empty()) return fail(ErrorKind::bad_input, filled->note);
    Body body{.mesh = std::move(filled->mesh), .making = Making::kRefilled, .notes = {}};
    body.mesh.gaps_m = surface_gaps(body.mesh.mesh, surface_, cells.size_m, true);
    tell(body, "filled the skin of a body stuffed", cells, stuffed->crumbs);
    return body;
  }

  void tell(Body& body, const char* made, const Cells& cells, int crumbs) const {
    body.notes.push_back(formatted(
        "{} with cells of {:.3g} mm{}", made, 1000 * cells.size_m,
        cells.size_m > cells.wanted_m ? ", coarser than its walls need, because finer cells would be too many" : ""));
    if (crumbs > 0) body.notes.push_back(formatted("left out: {} crumbs", crumbs));
    if (wall_m_ > 0 && cells.size_m > wall_m_) body.wall_elements = wall_m_ / cells.size_m;
  }

  const TriangleMesh& surface_;
  FillOptions options_;
  bool force_;
  const std::string& name_;
  const Progress& progress_;
  Eigen::RowVector3d box_;
  double volume_m3_ = 0, wall_m_ = 0;
};

}  // namespace

// Rays start slightly below the middles of triangles, one in each equal share of the area, and end at the crossing
// where they leave the body.
double wall_of_soup(const TriangleMesh& surface) {
  constexpr int kRays = 1000;
  const WindingNumber winding(surface);
  const double length = 1.01 * diagonal_of(surface), hair = 1e-6 * length;
  std::vector<double> up_to;  // area of all triangles up to each one
  double area = 0;
  const auto corner = [&surface](Eigen::Index t, int i) -> Eigen::Vector3d {
    return surface.nodes.row(surface.triangles(t, i)).transpose();
  };
  const auto twice_area = [&corner](Eigen::Index t) -> Eigen::Vector3d {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  };
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) up_to.push_back(area += 0.5 * twice_area(t).norm());
  std::vector<double> lengths;
  for (int ray = 0; ray < kRays && area > 0; ++ray) {
    const auto found = std::upper_bound(up_to.begin(), up_to.end(), (ray + 0.5) / kRays * area) - up_to.begin();
    const Eigen::Index t = std::min<std::ptrdiff_t>(found, surface.triangles.rows() - 1);
    const Eigen::Vector3d middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    Eigen::Vector3d inward = -twice_area(t).normalized();
    if (winding.inside(middle - hair * inward)) inward = -inward;
    const Eigen::Vector3d from = middle + hair * inward, to = from + length * inward;
    if (!winding.inside(from) || winding.inside(middle - hair * inward)) continue;  // triangle not at the skin
    for (const double crossing : winding.crossings(from, to)) {
      if (winding.inside(from + (crossing * length + hair) * inward)) continue;
      lengths.push_back(crossing * length + hair);
      break;
    }
  }
  if (lengths.empty()) return 0;
  const auto low =
      lengths.begin() + static_cast<std::ptrdiff_t>(kMinThicknessShare * static_cast<double>(lengths.size()));
  std::nth_element(lengths.begin(), low, lengths.end());
  return *low;
}

Result<Body> make_stuffed(const TriangleMesh& surface, const FillOptions& options, bool force_coarse,
                          const std::string& name, const Progress& progress) {
  return StuffedBody(surface, options, force_coarse, name, progress).run();
}

}  // namespace ringdown::mesh
