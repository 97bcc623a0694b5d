// How often a surface goes around a point: 1 inside a sound one, 0 outside, and for a soup of triangles something
// between that still tells the two apart. [any thread once made]
//
//   const WindingNumber winding(soup);
//   if (winding.inside(point)) ...
//
// The generalised winding number (Jacobson, Kavan & Sorkine-Hornung, ACM Trans. Graph. 32(4), 2013) is the sum of the
// triangles' solid angles over 4 pi, each exact (van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 1983). It is
// harmonic away from the triangles, jumps by one across each, and passes through one half across a hole. Doubled and
// overlapping parts add up. Far clusters of triangles are taken together as a dipole and its next two terms (Barill,
// Dickson, Schmidt, Levin & Jacobson, ACM Trans. Graph. 37(4), 2018). What that leaves out is bounded cluster by
// cluster, and where the bound is not good enough the clusters are opened, so errors hold for every surface.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::mesh {

class WindingNumber {
 public:
  // O(T log T). Triangles without area are passed over. A surface that is inside out is taken turned.
  explicit WindingNumber(const TriangleMesh& surface);

  // To within `tolerance` of the plain sum over all triangles; 0: that sum itself. On a triangle it is half way between
  // its two sides, or either.
  [[nodiscard]] double at(const Eigen::Vector3d& point, double tolerance = 1e-3) const;

  // at() > 1/2, as exactly as that takes, down to a tolerance of 1e-4.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point) const;

  // Where the way from a to b crosses triangles: fractions of it, ascending. Hits of a triangle's very edge may be
  // missed or come twice.
  [[nodiscard]] std::vector<double> crossings(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  // A triangle lies within the box, or near it: its bounding box does.
  [[nodiscard]] bool near(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;

  // The unit normal, outward as taken, of the triangle that the point lies on to within `reach`; false when on none.
  [[nodiscard]] bool normal_at(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& normal) const;

  // The surface was inside out as a whole.
  [[nodiscard]] bool turned() const { return turned_; }

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;
  struct Node {
    Eigen::Vector3d low, high;              // box
    Eigen::Vector3d centre, dipole, trace;  // expansion about `centre`; see expand()
    Eigen::Matrix3d gradient;
    std::array<double, 10> cubic;         // xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz
    double radius = 0, third = 0;         // of all corners from the centre; integral of that distance cubed, or more
    int first = 0, count = 0, right = 0;  // triangles; a leaf has right == 0, the left child follows its parent
  };
  struct Bounded {
    double value, error;
  };

  int build(int first, int count);
  [[nodiscard]] bool faces_inward() const;
  void expand(Node& node) const;
  static Bounded far_field(const Node& node, const Eigen::Vector3d& offset, double distance);
  [[nodiscard]] Bounded sum(const Eigen::Vector3d& point, double opening) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
  bool turned_ = false;
};

}  // namespace ringdown::mesh
