// A closed surface in ever fewer triangles, so that fields on it lose least. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace ringdown::mesh {

// Points of the original surface at which a coarse surface is compared with it.
struct SurfaceSamples {
  Points positions;        // N x 3 [m]
  Points normals;          // N x 3, outward, of length 1
  Eigen::VectorXd areas;   // N [m^2]
  Eigen::MatrixXf fields;  // F x N, free of units: the squares of a row add up to about 1, averaged over the surface
};

// The point of the coarse surface that stands for a sample: the nearest one.
struct SurfacePlace {
  std::uint32_t triangle = 0;       // position in Coarsening::triangles()
  std::array<double, 3> weights{};  // of its corners
};

// Removes one point after the other, each time the one that costs least, by moving it onto a neighbour. The cost is
// what linear interpolation loses, the sum over the samples of
//
//   area (|field - interpolated field|^2 + (distance / distance unit)^2)
//
// No step makes a triangle with an angle below kMinAngle_deg where none was, or turns one over. Every edge keeps its
// two triangles, so that closed pieces stay closed and apart. Points of
// sharp edges stay on these, and corners where they are. Edges are flipped, and points moved to a sample nearby,
// where that widens a narrow angle.
//
// Sources: Garland & Heckbert, Surface simplification using quadric error metrics, 1997 (the greedy order); Hoppe et
// al., Mesh optimization, 1993 (costs measured at samples that move with the mesh).
class Coarsening {
 public:
  // Every triangle has N / T samples at first, in the order of the triangles. `fields` (F x P) are at the points.
  Coarsening(const Points& points, std::vector<std::array<std::uint32_t, 3>> triangles, Eigen::MatrixXf fields,
             SurfaceSamples samples, double distance_unit_m);
  ~Coarsening();
  Coarsening(const Coarsening& other);
  Coarsening& operator=(Coarsening&&) noexcept;

  // Removes points until at most `points` are left. False when none can go any more. With `any_angle` narrow
  // triangles may be made and sharp edges lost.
  bool reduce_to(std::size_t points, bool any_angle = false);

  [[nodiscard]] std::size_t point_count() const;  // that are left

  // The triangles that are left, as numbers of the first points, and where on them each sample lies.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles() const;
  [[nodiscard]] std::vector<SurfacePlace> places() const;

  // P numbers: where each of the first points is now. Below P one of the first places, from P on that of a sample.
  [[nodiscard]] const std::vector<Eigen::Index>& origins() const;

 private:
  class Mesh;
  std::unique_ptr<Mesh> mesh_;
};

inline constexpr double kSharpEdge_deg = 40;  // between the normals of the first triangles
inline constexpr double kMinAngle_deg = 22;   // two degrees more than what is wanted, for fitted positions

}  // namespace ringdown::mesh
