#include "engine/mesh/surface/surface_gap.h"

#include "engine/base/in_parallel.h"
#include "engine/mesh/face_points.h"
#include "engine/mesh/stuffing/winding_number.h"
#include "engine/mesh/surface/smooth_facets.h"
#include "engine/mesh/surface/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace ringdown::mesh {
namespace {

using Eigen::Vector3d;

// Returns the fraction of the way from a, inside, to b, outside, at which the body ends: at a triangle, or in a hole
// where the winding number falls below one half.
double exit_fraction(const WindingNumber& winding, const Vector3d& a, const Vector3d& b) {
  constexpr double kStep = 1e-6;
  constexpr int kBisections = 12;
  for (const double crossing : winding.crossings(a, b)) {
    if (crossing + kStep >= 1 || !winding.inside(a + (crossing + kStep) * (b - a))) return crossing;
  }
  double in = 0, out = 1;
  for (int step = 0; step < kBisections; ++step) {
    const double middle = (in + out) / 2;
    (winding.inside(a + middle * (b - a)) ? in : out) = middle;
  }
  return (in + out) / 2;
}

double gap_to(const WindingNumber& winding, const Vector3d& at, const Vector3d& normal, double reach_m) {
  const bool inside = winding.inside(at);
  for (const double share : {0.25, 1.0}) {
    const Vector3d end = at + (inside ? share : -share) * reach_m * normal;
    if (winding.inside(end) == inside) continue;
    if (inside) return share * reach_m * exit_fraction(winding, at, end);
    return -share * reach_m * (1 - exit_fraction(winding, end, at));
  }
  return inside ? reach_m : -reach_m;
}

double gap_to(const SurfaceRays& rays, const Eigen::RowVector3d& at, const Eigen::RowVector3d& normal, double reach_m) {
  const double out = rays.along(at, normal, normal), in = rays.along(at, -normal, normal);
  const double gap = out < in ? out : -in;
  if (std::abs(gap) <= reach_m) return gap;
  const Eigen::RowVector3d way = rays.nearest(at) - at;  // beside an edge, where no triangle lies straight ahead
  return std::clamp(std::copysign(way.norm(), way.dot(normal)), -reach_m, reach_m);
}

}  // namespace

Eigen::VectorXd surface_gaps(const TetMesh& mesh, const TriangleMesh& surface, double reach_m, bool soup, int threads) {
  const FacePoints points = face_points(mesh);
  Eigen::VectorXd gaps(points.positions.rows());
  const SurfaceRays rays(surface);
  const SmoothFacets facets(surface);
  const auto for_all = [&](const auto& oracle) {
    threads = thread_count(threads);
    in_parallel(threads, [&](int thread) {
      for (Eigen::Index p = thread; p < gaps.size(); p += threads) {
        const Eigen::RowVector3d at = points.positions.row(p), normal = points.normals.row(p);
        const double gap = gap_to(oracle, at, normal, reach_m);
        const Eigen::RowVector3d on = at + gap * normal;
        const double rise = facets.rise(rays.nearest_triangle(on), on).dot(normal);
        gaps[p] = std::clamp(gap + rise, -reach_m, reach_m);
      }
    });
  };
  if (soup) {
    for_all(WindingNumber(surface));
  } else {
    for_all(rays);
  }
  return gaps;
}

}  // namespace ringdown::mesh
