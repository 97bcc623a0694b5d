// The equation of the combined layer at one wavenumber, as a dense matrix. [worker]
//
// Outside the body the field is that of a layer with density mu on its surface,
//
//   p(x) = integral of (d/dn(y) - i eta) G(x, y) mu(y) dS,       G = exp(ikR) / (4 pi R)
//
// whose normal derivative is the given flow q: N mu - i eta (D' - 1/2) mu = q. With eta > 0 it has one solution at
// every k (Brakhage & Werner 1965 for the other boundary condition; Burton & Miller 1971 is its transpose); with eta =
// 0 it is the double layer alone, whose matrix is nearly singular where the air inside the body would resonate. Tested
// with hat functions, N needs no derivative of G (Maue 1949):
//
//   A_ij = integrals of G (k^2 n(x).n(y) hat_i hat_j - curl hat_i . curl hat_j) - i eta_j (hat_i dG/dn(x) hat_j)  + i/2
//   eta_j hat_i hat_j
//
// The integrals are sums over the middles of sides; near_integrals.h corrects those of near triangles.
#pragma once

#include "engine/radiate/near_integrals.h"
#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::radiate {

using ComplexMatrix = Eigen::Matrix<std::complex<float>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Writes the V x V matrix between the part (rows) and one of its images (columns). A matrix of the right size keeps its
// memory. `coupling` has eta at each node [1/m]. About 45 ns per entry on one core with 512-bit vectors.
void wave_matrix(const Panels& part, int image, const NearIntegrals& near, double wavenumber_rad_m,
                 const std::vector<double>& coupling, ComplexMatrix& matrix, int threads = 1);

}  // namespace ringdown::radiate
