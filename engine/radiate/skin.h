// The surface of a body in triangles of one size, with all data that do not depend on the wavenumber. [worker]
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

// The body as given, from which every skin is made. Keeps references to the body.
class Original {
 public:
  // The surface must be closed and turned outward. It may have mirror planes, which are the first coordinate planes.
  static Result<Original> of(const Body& body, int mirrors = 0);

  const Body* body = nullptr;
  int mirrors = 0;
  mesh::TriangleMesh part;  // the whole surface if there are no mirror planes
  std::shared_ptr<const Panels> panels;
  std::shared_ptr<const SurfaceSearch> search;
  // The surface on which walls are measured, and the distance from each of its triangles straight inward to the next
  // face [m].
  std::shared_ptr<const Panels> walls;
  std::shared_ptr<const SurfaceSearch> wall_search;
  std::vector<double> thickness_m;
};

// A skin of a surface with mirror planes is a part of it, and a field on the whole surface is a sum of classes, one for
// each image. Bit a of a class's number says that the class changes its sign across plane a. On image g, a class equals
// its value on the part times (-1)^(number of bits that class and g have in common). A class that changes its sign
// across a plane is 0 on that plane.
struct Skin {
  Panels panels;
  std::vector<NearIntegrals> near;           // integrals with each image
  std::vector<double> thickness_m;           // V
  std::vector<std::vector<int>> zero_nodes;  // for each class, the nodes on which it is 0
  // One matrix for each class, V x M [m^2 kg^-1/2]: the integrals over the part of each hat function times the class's
  // share of phi.n.
  std::vector<Eigen::MatrixXf> flow;
};

// The sign of a class on an image, relative to its sign on the part.
inline int sign_of(int image_class, int image) {
  return std::popcount(static_cast<unsigned>(image_class & image)) % 2 == 0 ? 1 : -1;
}

// Makes a skin. Nodes are moved out or in by the mean distance of the flat triangles around them from the old surface,
// so that a coarse skin has the volume of the body. Each sample's flow goes to the corners of the nearest triangle, so
// the total flow is kept to rounding.
Result<Skin> skin_of(const Original& original, double side_m);
// Makes a skin of tiles of the original's part.
Result<Skin> skin_of(const Original& original, mesh::TriangleMesh tiles);

// For each node, the mean of the normals of its triangles and of their images, weighted by area.
std::vector<Eigen::Vector3d> node_normals(const Panels& panels);

// A third of the area of the triangles around each node.
Eigen::VectorXf node_areas(const Panels& panels);

// The coupling of the two layers at each node: eta = k min(1, k thickness). A bulky body has the combined layer with
// eta = k. Where a wall is thin compared with the wave, the simple layer fades out and only the double layer remains.
std::vector<double> coupling_of(const Skin& skin, double wavenumber_rad_m);

// The wavenumber of each mode's pattern [rad/m]: rms of the gradient of its normal motion over the rms of the motion.
std::vector<double> shape_wavenumbers(const Skin& skin);

// The flow dG/dn, G = exp(ikR)/(4 pi R), of a point source at `inside`, V x classes: the integrals over the part of
// each hat function times each class's share of dG/dn. Triangles are divided until they are smaller than 0.4 of their
// distance.
Eigen::MatrixXcf source_flow(const Skin& skin, const Eigen::Vector3d& inside, double wavenumber_rad_m);

// Two places inside the body, in its thickest wall and in a wall of medium thickness.
std::vector<Eigen::Vector3d> inner_places(const Original& original);

}  // namespace ringdown::radiate
