// The matrices of a skin's classes at every wavenumber of a narrow band, from those at three. [worker]
//
// An entry is exp(ikR) times a function that changes slowly with k; R is the distance between the entry's two nodes.
// The function has only the phases of distance differences of a triangle or two. In a band no wider than kWidestBand it
// is a parabola to about 1e-3, and an entry costs 3 ns instead of 45. The whole band has the coupling of its middle:
// every coupling above 0 has the same answer.
#pragma once

#include "engine/radiate/skin.h"
#include "engine/radiate/wave_matrix.h"

#include <array>
#include <vector>

namespace ringdown::radiate {

inline constexpr double kWidestBand = 1.27;  // highest over lowest wavenumber

// One matrix for each class of a skin, V x V: the sum over the images of their matrices, with the signs of the class.
// Nodes on which a class is 0 have a row and a column of 0 except on the diagonal.
using ClassMatrices = std::vector<ComplexMatrix>;

// Computes the matrices at one wavenumber, each entry directly. `matrices` of the right size keep their memory.
void class_matrices(const Skin& skin, double wavenumber_rad_m, const std::vector<double>& coupling,
                    ClassMatrices& matrices, int threads = 1);

// Keeps a reference to the skin, which must live as long.
class WaveBand {
 public:
  // Prepares for `wavenumbers` wavenumbers, from the lowest to the highest. If they are few, or if the band has no
  // width, nothing is prepared and each matrix is computed directly.
  WaveBand(const Skin& skin, double lowest_rad_m, double highest_rad_m, int wavenumbers, int threads);

  // May be called by several threads at once.
  void matrices_at(double wavenumber_rad_m, ClassMatrices& matrices) const;

  [[nodiscard]] const Skin& skin() const { return skin_; }
  [[nodiscard]] const std::vector<double>& coupling() const { return coupling_; }

 private:
  const Skin& skin_;
  std::vector<double> coupling_;  // V
  double middle_rad_m_ = 0;
  std::array<double, 3> wavenumbers_{};
  // Matrices at wavenumbers_, for each image, with the phase exp(ikR) of the middle; or empty.
  std::array<std::vector<ComplexMatrix>, 3> matrices_;
};

}  // namespace ringdown::radiate
