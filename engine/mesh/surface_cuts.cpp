#include "engine/mesh/surface_cuts.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>

namespace ringdown::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

struct Enough {};

class Cutter {
 public:
  Cutter(const TriangleMesh& mesh, std::size_t most) : mesh_(mesh), most_(most) {}

  std::vector<std::array<std::int32_t, 2>> run() {
    std::vector<Box> boxes;
    for (std::int32_t t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!triangle(t).is_degenerate()) boxes.emplace_back(triangle(t).bbox(), t);
    }
    try {
      CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [this](const Box& a, const Box& b) {
        const std::int32_t first = std::min<std::int32_t>(a.info(), b.info());
        const std::int32_t second = std::max<std::int32_t>(a.info(), b.info());
        if (!cut(first, second)) return;
        found_.push_back({first, second});
        if (found_.size() >= most_) throw Enough();
      });
    } catch (const Enough&) {
    }
    std::sort(found_.begin(), found_.end());
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::int32_t node(std::int32_t t, int i) const { return mesh_.triangles(t, i % 3); }
  [[nodiscard]] Point point(std::int32_t t, int i) const {
    const std::int32_t n = node(t, i);
    return {mesh_.nodes(n, 0), mesh_.nodes(n, 1), mesh_.nodes(n, 2)};
  }
  [[nodiscard]] Triangle triangle(std::int32_t t) const { return {point(t, 0), point(t, 1), point(t, 2)}; }

  [[nodiscard]] bool cut(std::int32_t a, std::int32_t b) const {
    int shared = 0, at_a = 0, at_b = 0, sum_a = 0, sum_b = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (node(a, i) != node(b, j)) continue;
        ++shared;
        at_a = i, at_b = j;
        sum_a += i, sum_b += j;
      }
    }
    if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
    if (shared == 1) return meet_beyond_corner(a, at_a, b, at_b);
    return shared == 2 && folded(a, 3 - sum_a, b, 3 - sum_b);
  }

  // They have one corner in common; they cut when the side opposite to it meets the other triangle.
  [[nodiscard]] bool meet_beyond_corner(std::int32_t a, int at_a, std::int32_t b, int at_b) const {
    const Kernel::Segment_3 side_a(point(a, at_a + 1), point(a, at_a + 2)),
        side_b(point(b, at_b + 1), point(b, at_b + 2));
    return CGAL::do_intersect(side_a, triangle(b)) || CGAL::do_intersect(side_b, triangle(a));
  }

  // They have a side in common, and lie on the same half of one plane.
  [[nodiscard]] bool folded(std::int32_t a, int apex_a, std::int32_t b, int apex_b) const {
    const Point p = point(a, apex_a + 1), q = point(a, apex_a + 2), r = point(a, apex_a), s = point(b, apex_b);
    return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
  }

  const TriangleMesh& mesh_;
  std::size_t most_;
  std::vector<std::array<std::int32_t, 2>> found_;
};

}  // namespace

std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t most) {
  return Cutter(mesh, most).run();
}

}  // namespace ringdown::mesh
