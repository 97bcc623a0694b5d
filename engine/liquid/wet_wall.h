// Which part of a body's skin a liquid wets. [worker]
//
// A level is a height along `up`. The skin below it falls into pieces that do not touch each other. With n out of the
// body, the integral of (level - height) n.up over a piece is the volume of liquid that it holds: positive in a basin
// or a closed cavity, negative on the outside of the body.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace ringdown::liquid {

// The skin of a body in any unit of length.
struct Skin {
  mesh::TriangleMesh surface;       // closed, counter-clockwise from outside
  mesh::SurfaceQuadrature samples;  // interpolates from the surface's nodes
  mesh::Points at;                  // N x 3, positions of the samples
};

// Three samples for each flat triangle.
Skin flat_skin(mesh::TriangleMesh surface);
// The skin of elements, with samples on their curved faces.
Skin skin_of(const mesh::TetMesh& mesh, const mesh::Boundary& boundary);

// One piece of the skin below a level.
struct Piece {
  std::vector<Eigen::Index> triangles;  // that lie below the level, at least in part
  int lowest = 0;                       // its lowest node
  double volume = 0;                    // of liquid; negative on the outside
  double opening = 0;                   // area of the liquid's free surface, negative on the outside; about 0 in a
                                        // closed cavity
  double area = 0;
  [[nodiscard]] bool is_basin() const { return volume > 0; }
  [[nodiscard]] bool is_closed() const { return std::abs(opening) < 1e-6 * area; }
};

// Cuts the skin at levels.
class WetWall {
 public:
  WetWall(const Skin& skin, const Eigen::Vector3d& up);

  [[nodiscard]] std::vector<Piece> pieces_below(double level) const;
  [[nodiscard]] double height(int node) const { return heights_[node]; }
  [[nodiscard]] double lowest() const { return heights_.minCoeff(); }
  [[nodiscard]] double highest() const { return heights_.maxCoeff(); }
  [[nodiscard]] const Skin& skin() const { return skin_; }
  [[nodiscard]] const Eigen::Vector3d& up() const { return up_; }

 private:
  const Skin& skin_;
  const Eigen::Vector3d up_;
  Eigen::VectorXd heights_;
};

// A place of the body that holds liquid.
struct Basin {
  int bottom = 0;     // its lowest node
  double rim = 0;     // the highest level that it holds
  double volume = 0;  // up to the rim
};

// Every basin that holds more than a thousandth of what the largest one holds, the largest first. A basin that opens
// into a lower one counts up to there. Closed cavities have the rim at their top.
std::vector<Basin> basins_of(const WetWall& wall);

// The filling of a basin, given in one of three ways.
struct Amount {
  enum class Kind { kFull, kLevel, kDepth, kVolume } kind = Kind::kFull;
  double value = 0;  // level or depth in the unit of length, or volume in its third power
};

// The level at which a basin holds the amount. Fails with a sentence when that lies below its bottom or above its rim;
// `metre` is one metre in the unit of length, for the sentence.
Result<double> level_of(const WetWall& wall, const Basin& basin, const Amount& amount, double metre);

// The piece that the basin's liquid wets at a level.
Piece piece_of(const WetWall& wall, const Basin& basin, double level);

}  // namespace ringdown::liquid
