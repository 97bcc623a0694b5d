// Poles of a sum of exponentials in noise, without a start value: ESPRIT.
//
// Windows of the signal, one third of its length, are vectors in a space of which the exponentials span a small part. A
// window one sample on is the same part, each exponential multiplied by its pole; so the poles are the eigenvalues of
// the map between the part without its last and without its first row.
// Source: Roy & Kailath, IEEE Trans. Acoust. Speech Signal Process. 37(7), 1989; damped exponentials: Badeau, Boyer &
// David, EUSIPCO 2002. [any]
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::fit {

// Logarithms of poles, per sample; at most `most` of them. Rather too many than too few: directions in which the signal
// has no more than noise has by chance are left out, and the rest is for refine.h to judge. None when the signal has
// fewer than kMinSamples.
std::vector<std::complex<double>> find_poles(const Eigen::VectorXcd& signal, Eigen::Index most);

inline constexpr Eigen::Index kMinSamples = 24;

}  // namespace ringdown::fit
