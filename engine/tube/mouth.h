// The air between a body and the mouth of a tube, by boundary elements. [worker]
//
// The body and the tube, closed by a lid, are two rigid bodies in one air. Per wavenumber each mode of the body moves
// its own skin, and one more right-hand side moves the lid like a piston of velocity 1. The answers are
//
//   B_i = mean over the lid of the P that mode i causes        A = mean over the lid of the P that the lid causes
//
// with P = p / (i rho omega), and the far field of the lid. The force of the tube's air on mode i is S B_i per pressure
// in the mouth by reciprocity. Only the first few radii of the tube stand in the air: what lies farther from the mouth
// changes neither.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/radiation_map.h"
#include "engine/radiate/body.h"
#include "engine/radiate/skin.h"
#include "engine/tube/line.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::tube {

struct MouthPlace {
  Eigen::Vector3d middle;
  Eigen::Vector3d axis;  // unit vector into the tube
  double radius = 0;
  double length = 0;  // of the tube
};

struct MouthAnswer {
  Outside outside;                          // A
  Eigen::VectorXcd from_body;               // M: B
  std::vector<std::complex<double>> field;  // the lid's far field in harmonics, about `origin`
  double end_error_m = 0;                   // estimated error of Re A
  double bond_error = 0;                    // estimated relative error of the largest B
};

class Mouth {
 public:
  // All lengths in one unit. Fails when the tube and the body are not apart. `nodes`: of the finer of two skins.
  static Result<Mouth> of(const radiate::Body& body, const MouthPlace& place, int nodes = 2000);

  // With the extrapolation of radiate/wave_pair.h to ever finer skins. About 3 s of one core.
  [[nodiscard]] MouthAnswer at(double wavenumber_rad_m, const Eigen::Vector3d& origin, int threads = 0) const;

 private:
  struct Grid {
    radiate::Skin skin;
    std::vector<int> lid;  // its triangles
  };
  struct Fields {
    std::complex<double> end;
    Eigen::VectorXcd from_body;
    Eigen::VectorXcd harmonics;
  };
  Mouth(MouthPlace place, double reach) : place_(std::move(place)), reach_(reach) {}
  [[nodiscard]] Fields fields_on(const Grid& grid, double k, const Eigen::Vector3d& origin, int threads) const;

  MouthPlace place_;
  double reach_ = 0;  // radius of the sphere about the lid that holds everything
  std::vector<Grid> grids_;
};

}  // namespace ringdown::tube
