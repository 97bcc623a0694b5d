// Computes how often a surface goes around a point: 1 inside a sound surface, 0 outside. For a soup of triangles the
// number lies in between and still separates inside from outside. [any thread once made]
//
//   const WindingNumber winding(soup);
//   if (winding.inside(point)) ...
//
// The generalised winding number (Jacobson, Kavan & Sorkine-Hornung, ACM Trans. Graph. 32(4), 2013) is the sum of the
// triangles' solid angles over 4 pi, each exact (van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 1983). It is
// harmonic away from the triangles, jumps by one across each, and passes through one half across a hole. Doubled and
// overlapping parts add up. Far clusters of triangles are approximated by a dipole and its next two terms (Barill,
// Dickson, Schmidt, Levin & Jacobson, ACM Trans. Graph. 37(4), 2018). The error is bounded for each cluster, and
// clusters are opened where the bound is too large, so the tolerance holds for every surface.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::mesh {

class WindingNumber {
 public:
  // O(T log T). Triangles without area are ignored. A surface that is inside out is turned first.
  explicit WindingNumber(const TriangleMesh& surface);

  // Returns the winding number to within `tolerance` of the plain sum over all triangles; 0: the plain sum itself. On a
  // triangle the result is the value on one side, or midway between both.
  [[nodiscard]] double at(const Eigen::Vector3d& point, double tolerance = 1e-3) const;

  // Returns at() > 1/2, refined as far as the decision needs, down to a tolerance of 1e-4.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point) const;

  // Returns the places where the segment from a to b crosses triangles, as ascending fractions of its length. Hits
  // exactly on a triangle's edge may be missed or occur twice.
  [[nodiscard]] std::vector<double> crossings(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  // Returns true if the bounding box of some triangle meets the box.
  [[nodiscard]] bool near(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;

  // Finds the unit normal, outward, of the triangle within `reach` of the point; returns false if there is none.
  [[nodiscard]] bool normal_at(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& normal) const;

  // Returns true if the whole surface was inside out.
  [[nodiscard]] bool turned() const { return turned_; }

 private:
  using Triangle = std::array<Eigen::Vector3d, 3>;
  struct Node {
    Eigen::Vector3d low, high;              // box
    Eigen::Vector3d centre, dipole, trace;  // expansion about `centre`; see expand()
    Eigen::Matrix3d gradient;
    std::array<double, 10> cubic;         // xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz
    double radius = 0, third = 0;         // largest distance from the centre; bound of the integral of distance cubed
    int first = 0, count = 0, right = 0;  // triangles; a leaf has right == 0, the left child follows its parent
  };
  struct Bounded {
    double value, error;
  };

  int build(int first, int count);
  [[nodiscard]] bool faces_inward() const;
  void expand(Node& node) const;
  static Bounded far_field(const Node& node, const Eigen::Vector3d& offset, double distance);
  template <class Enter, class Leaf>
  void descend(const Enter& enter, const Leaf& leaf) const;
  [[nodiscard]] Bounded sum(const Eigen::Vector3d& point, double opening) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
  bool turned_ = false;
};

}  // namespace ringdown::mesh
