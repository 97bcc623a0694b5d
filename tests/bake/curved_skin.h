// The skin of a tetrahedral mesh with its curvature, and what finite elements mean by the points between its nodes.
//
// The oracle for banks' shapes. Shares nothing with engine/mesh/boundary.h and engine/fem: faces are found anew from
// the order of nodes that tet_element.h documents, and a face's interpolation comes from inverting the Vandermonde
// matrix of the monomials u^i v^j, i + j <= p, at the nodes of the face. On a face opposite corner c of an element,
// every shape function that belongs to another node of the element is zero, so the nodes of the face alone determine
// position and displacement there.
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::test {

struct SkinPoint {
  Eigen::Vector3d at_m;
  Eigen::Vector3d normal;           // of length 1, outward, of the curved face
  std::vector<Eigen::Index> nodes;  // of the face, as positions in CurvedSkin::nodes()
  Eigen::VectorXd weights;          // of these nodes; they sum to 1
};

class CurvedSkin {
 public:
  // The faces that belong to one element only. The elements must be positively oriented.
  explicit CurvedSkin(const mesh::TetMesh& mesh);

  // S numbers of nodes of the mesh, ascending: all that lie on a face of the skin.
  [[nodiscard]] const std::vector<std::int32_t>& nodes() const { return nodes_; }
  [[nodiscard]] std::size_t face_count() const { return faces_.size(); }

  // [m^2], by the midpoint rule on 144 parts of each face.
  [[nodiscard]] double area() const { return area_; }

  // Points distributed uniformly over the area. The same seed gives the same points.
  [[nodiscard]] std::vector<SkinPoint> random_points(std::size_t count, std::uint64_t seed) const;

 private:
  struct Face {
    int kind;  // the corner of the element that it does not have
    std::vector<Eigen::Index> nodes;
    Eigen::Matrix<double, Eigen::Dynamic, 3> at_m;
    double largest_stretch;  // at least the largest |dx/du x dx/dv|
  };
  struct Kind {
    std::vector<int> nodes;        // of the element, numbers in its order
    Eigen::MatrixXd coefficients;  // weights = coefficients^T * monomials(u, v)
  };

  [[nodiscard]] Eigen::Vector3d stretched_normal(const Face& face, double u, double v) const;

  int order_;
  std::array<Kind, 4> kinds_;
  std::vector<Face> faces_;
  std::vector<double> steps_;  // running sums of largest_stretch, for the choice of a face
  std::vector<std::int32_t> nodes_;
  double area_ = 0;
};

// 3 x m: the displacement of the point in modes of which `shapes`, 3S x m, are the values at the skin's nodes.
Eigen::Matrix3Xd displacement(const SkinPoint& point, const Eigen::MatrixXd& shapes);

}  // namespace ringdown::test
