// Tetrahedra that are parts of a body's elements, and points inserted into them. [worker]
//
// A point may be inserted into a tetrahedron, a face or an edge. Every tetrahedron that has the simplex is then
// replaced by one for each of the simplex's corners, in which the new point takes the corner's place (a stellar
// subdivision). All tetrahedra around the simplex take part, so neighbours always fit. Orientation and volume are kept
// wherever inside its simplex a point lies.
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::shatter {

// A tetrahedron in one element of the body. Its map to space is the element's, restricted to it.
struct SubElement {
  std::array<std::int32_t, 4> corners{};  // numbers of points
  std::int32_t parent = 0;                // the body's element
  Eigen::Matrix4d barycentric;            // row c: coordinates of corner c in the element; the determinant is > 0
};

// The corners of an edge, a face or a tetrahedron, ascending; -1 fills the places that are not used, at the end.
using Simplex = std::array<std::int32_t, 4>;

Simplex simplex_of(std::array<std::int32_t, 4> corners, int count);  // of the first `count` corners

struct Insertion {
  Simplex simplex{};
  std::array<double, 4> weights{};  // of its corners, in their order; > 0, sum 1
  std::int32_t point = 0;           // the number of the new point
};

class Refinement {
 public:
  // Begins with tetrahedra that exist already. `points`: N x 3.
  Refinement(std::vector<SubElement> elements, mesh::Points points);

  // Begins with the straight elements of a body; point n is the n-th node that is a corner.
  explicit Refinement(const mesh::TetMesh& body);

  // Takes another refinement's tetrahedra as elements of their own: `parent` is then the number of one of them.
  static Refinement of_elements(const Refinement& other);

  [[nodiscard]] const std::vector<SubElement>& elements() const { return elements_; }
  [[nodiscard]] Eigen::Index point_count() const { return static_cast<Eigen::Index>(points_.size()); }
  [[nodiscard]] const Eigen::Vector3d& point(Eigen::Index number) const { return points_[number]; }

  // Returns all simplices of `count` corners for which `wanted(simplex)` holds, each once, ascending. O(E).
  template <class Wanted>
  [[nodiscard]] std::vector<Simplex> find(int count, const Wanted& wanted) const;

  // Adds points to simplices that all have `count` corners; sets Insertion::point, in sequence from point_count(). Two
  // edges of one face are split in the order of their lengths, the longer first. O(E).
  void insert(std::vector<Insertion>& insertions, int count);

 private:
  std::vector<SubElement> elements_;
  std::vector<Eigen::Vector3d> points_;
};

// Returns the subsets of `count` of the four corners: bit c of a subset is set if corner c is in it.
std::vector<int> corner_subsets(int count);

// Returns the simplex between the corners of a subset.
Simplex simplex_of(const SubElement& element, int subset);

// Returns each simplex once, ascending.
std::vector<Simplex> unique(std::vector<Simplex> simplices);

template <class Wanted>
std::vector<Simplex> Refinement::find(int count, const Wanted& wanted) const {
  std::vector<Simplex> found;
  const std::vector<int> subsets = corner_subsets(count);
  for (const SubElement& element : elements_) {
    for (const int subset : subsets) {
      if (const Simplex simplex = simplex_of(element, subset); wanted(simplex)) found.push_back(simplex);
    }
  }
  return unique(std::move(found));
}

}  // namespace ringdown::shatter
