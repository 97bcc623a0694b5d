// The surface of a body in triangles of one size, with all that does not depend on the wavenumber. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/radiate/body.h"
#include "engine/radiate/near_integrals.h"
#include "engine/radiate/panels.h"
#include "engine/radiate/surface_search.h"

#include <Eigen/Core>

#include <bit>
#include <memory>
#include <vector>

namespace ringdown::radiate {

// The body as it was given: what every skin is made from. Keeps references to it.
class Original {
 public:
  // The surface must be closed and turned outward. It may have mirror planes, which are the first coordinate planes.
  static Result<Original> of(const Body& body, int mirrors = 0);

  const Body* body = nullptr;
  int mirrors = 0;
  mesh::TriangleMesh part;  // without mirror planes the whole surface
  std::shared_ptr<const Panels> panels;
  std::shared_ptr<const SurfaceSearch> search;
  // Where walls are measured, and how far one comes from each of its triangles straight inward [m].
  std::shared_ptr<const Panels> walls;
  std::shared_ptr<const SurfaceSearch> wall_search;
  std::vector<double> thickness_m;
};

// A skin of a surface with mirror planes is a part of it, and a field on the whole surface is a sum of classes, one for
// each image. Bit a of a class's number says that the class changes its sign across plane a: on image g of the part it
// is (-1)^(number of bits that class and g have in common) times what it is on the part. A class that changes its sign
// across a plane is 0 on it.
struct Skin {
  Panels panels;
  std::vector<NearIntegrals> near;           // with each image
  std::vector<double> thickness_m;           // V
  std::vector<std::vector<int>> zero_nodes;  // for each class those on which it is 0
  // One matrix for each class, V x M [m^2 kg^-1/2]: the integrals over the part of each hat function times the class's
  // share of phi.n.
  std::vector<Eigen::MatrixXf> flow;
  double side_m = 0;
};

// The sign of a class on an image, beside that on the part.
inline int sign_of(int image_class, int image) {
  return std::popcount(static_cast<unsigned>(image_class & image)) % 2 == 0 ? 1 : -1;
}

// Nodes are moved out or in by the mean distance of the flat triangles around them from the old surface, so that a
// coarse skin has the volume of the body. Each sample's flow goes to the corners of the triangle nearest to it: what
// flows in sum is kept to rounding.
Result<Skin> skin_of(const Original& original, double side_m);

// At each node the mean of the normals of its triangles and of their images, weighted by their areas.
std::vector<Eigen::Vector3d> node_normals(const Panels& panels);

// A third of the area of the triangles around each node.
Eigen::VectorXf node_areas(const Panels& panels);

// The coupling of the two layers at each node: eta = k min(1, k thickness). A bulky body has the combined layer with
// eta = k; where a wall is thin beside the wave the simple layer fades out and the double layer alone is left.
std::vector<double> coupling_of(const Skin& skin, double wavenumber_rad_m);

// 1 over the length [rad/m] over which each mode's normal motion changes: rms of its gradient over its rms.
std::vector<double> shape_wavenumbers(const Skin& skin);

// The flow dG/dn, G = exp(ikR)/(4 pi R), of a point source at `inside`: the integrals over the part of each hat
// function times each class's share of it, V x classes. Triangles are divided until they are smaller than 0.4 of their
// distance.
Eigen::MatrixXcf source_flow(const Skin& skin, const Eigen::Vector3d& inside, double wavenumber_rad_m);

// Two places inside of the body, in its thickest wall and in a middling one.
std::vector<Eigen::Vector3d> inner_places(const Original& original);

}  // namespace ringdown::radiate
