// The poles of functions that are known at a few real places, by rational approximation. [any thread]
//
// AAA (Nakatsukasa, Sete & Trefethen, SIAM J. Sci. Comput. 40, 2018, A1494): a quotient of two sums over support
// points z_j,
//
//   r(z) = sum of w_j f_j / (z - z_j)  over  sum of w_j / (z - z_j)
//
// takes the values f_j there. The next support point is the sample where r is worst; the weights w make the error of
// the linearised equation at all other samples least. Several functions share support points and weights, and with
// them their poles.
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::cavity {

struct Pole {
  std::complex<double> at;
  double strength = 0;  // length of the vector of residues over |at| and the median length of the samples
};

// The poles of functions whose samples at N different places are the rows of `values` (N x F). Approximates until the
// largest error is below `tolerance` times the largest sample, with N/2 support points at most. N is at least 4.
std::vector<Pole> poles_of(const Eigen::VectorXd& places, const Eigen::MatrixXcd& values, double tolerance);

}  // namespace ringdown::cavity
