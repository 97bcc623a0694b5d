// Reduces the triangles of a closed surface with the least loss to given fields on it. [worker]
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

// The point of the coarse surface that represents a sample: the nearest point.
struct SurfacePlace {
  std::uint32_t triangle = 0;       // position in Coarsening::triangles()
  std::array<double, 3> weights{};  // weights of the triangle's corners
};

// Removes points one by one, each time the cheapest, by moving the point onto a neighbour. The cost is the error of
// linear interpolation, the sum over the samples of
//
//   area (|field - interpolated field|^2 + (distance / distance unit)^2)
//
// No step makes an angle below kMinAngle_deg where none was, or turns a triangle over. Every edge keeps its two
// triangles, so closed pieces stay closed and apart. Points of sharp edges stay on those edges, and corners do not
// move. Edges are flipped, and points moved to a nearby sample, where this widens a narrow angle.
//
// Sources: Garland & Heckbert, Surface simplification using quadric error metrics, 1997 (the greedy order); Hoppe et
// al., Mesh optimization, 1993 (costs measured at samples that move with the mesh).
class Coarsening {
 public:
  // Initially every triangle has N / T samples, in the order of the triangles. `fields` (F x P) are at the points.
  Coarsening(const Points& points, std::vector<std::array<std::uint32_t, 3>> triangles, Eigen::MatrixXf fields,
             SurfaceSamples samples, double distance_unit_m);
  ~Coarsening();
  Coarsening(const Coarsening& other);
  Coarsening& operator=(Coarsening&&) noexcept;

  // Removes points until at most `points` are left. Returns false if no further point can be removed. With `any_angle`,
  // narrow triangles may appear and sharp edges may be lost.
  bool reduce_to(std::size_t points, bool any_angle = false);

  [[nodiscard]] std::size_t point_count() const;  // number of points left

  // triangles(): the remaining triangles, as numbers of the original points. places(): the place of each sample on
  // them.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangles() const;
  [[nodiscard]] std::vector<SurfacePlace> places() const;

  // P numbers, the present place of each original point: below P the place of an original point, from P on of a sample.
  [[nodiscard]] const std::vector<Eigen::Index>& origins() const;

 private:
  class Mesh;
  std::unique_ptr<Mesh> mesh_;
};

inline constexpr double kSharpEdge_deg = 40;  // angle between the normals of the original triangles
inline constexpr double kMinAngle_deg = 22;   // two degrees above the target, as a reserve for fitted positions

}  // namespace ringdown::mesh
