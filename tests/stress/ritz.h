// Frequencies of free elastic bodies by Rayleigh-Ritz with polynomials over the whole body: the truth that the stress
// suite holds finite elements against. It shares no code with engine/.
//
// The displacement is a sum of products of one polynomial and one axis; stiffness and mass are integrals over the body,
// known in closed form; the eigenvalues fall to the exact ones as the degree grows. Sources: Ohno, J. Phys. Earth 24,
// 1976; Visscher, Migliori, Bell & Reinert, J. Acoust. Soc. Am. 90, 1991.
#pragma once

#include "engine/fem/elastic.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::test {

// The elastic frequencies [Hz] of a box, ascending, the first `count` of them. Orthonormal Legendre polynomials
// of degrees up to `degree` along each axis and up to `total` together.
std::vector<double> box_frequencies(const Eigen::Vector3d& size_m, const fem::Elastic& elastic,
                                    const Eigen::Vector3i& degree, int total, std::size_t count);

// Frequencies with degrees that suffice for the first dozens of modes of a chunky box: converged to 1e-6.
std::vector<double> box_frequencies(const Eigen::Vector3d& size_m, const fem::Elastic& elastic, std::size_t count);

// Of a tetrahedron with the corners in rows [m], by monomials of up to `degree` (at most 8, for rounding's sake). With
// degree p these are the displacements of one straight Lagrange element of order p, so the frequencies are that
// element's, too.
std::vector<double> tetrahedron_frequencies(const Eigen::Matrix<double, 4, 3>& corners, const fem::Elastic& elastic,
                                            int degree, std::size_t count);

}  // namespace ringdown::test
