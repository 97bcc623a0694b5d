// Finds where on an object's surface a strike lands.
//
// The index is a bounding-volume hierarchy over the bank's triangles, or over its points if there are no triangles. The
// worker builds it once. The audio thread finds the surface point nearest to any point in less than a microsecond for a
// thousand triangles, without allocation, with a stack of fixed depth.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::modal {

// A point of the surface as a weighted mean of three sample points; the weights are >= 0 and sum to 1.
struct SurfacePoint {
  std::array<std::uint32_t, 3> points{};
  std::array<double, 3> weights{};
  double distance_m = 0;  // distance from the query point
};

class SurfaceIndex {
 public:
  // O(n log n). The bank must have passed read_bank's checks. [worker]
  explicit SurfaceIndex(const Bank& bank);

  // The nearest point of the surface; `query` is in the object frame and finite. [audio]
  [[nodiscard]] SurfacePoint nearest(Vec3 query) const REALTIME;

  // The size of the surface: the diagonal of its bounding box. [any]
  [[nodiscard]] double size_m() const;

  // The distance of `query` from the bounding box; 0 inside. [any]
  [[nodiscard]] double distance_m(Vec3 query) const;

 private:
  struct Triangle {
    std::array<std::uint32_t, 3> points;
    std::array<Vec3, 3> corners;
  };
  // Up to four children and their boxes, side by side, so that four distances are computed at once.
  struct Node {
    static constexpr std::size_t kChildren = 4;
    static constexpr std::uint32_t kTriangle = 1u << 31, kNone = ~0u;
    using Four = std::array<float, kChildren>;

    std::array<Four, 3> middle{}, half{};                                    // of each axis
    std::array<std::uint32_t, kChildren> child{kNone, kNone, kNone, kNone};  // or a node, or kTriangle + a triangle

    [[nodiscard]] Four squared_distances(const std::array<float, 3>& query) const REALTIME;
  };

  std::uint32_t halve(std::uint32_t begin, std::uint32_t end);
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // the first is the root
  Vec3 low_m_, high_m_;      // corners of the bounding box
  double reach_m_ = 0;       // its largest coordinate, of either sign
};

}  // namespace ringdown::modal
