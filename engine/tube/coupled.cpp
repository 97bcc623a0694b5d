#include "engine/tube/coupled.h"

#include "engine/dense/decompositions.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

namespace ringdown::tube {
namespace {

using Eigen::Index;

constexpr double kParallel = 1e-3;           // x^T x over x^H x at which two eigenvectors count as one
constexpr double kDetune = 0.5 / 1731.2340;  // half a cent

// Which eigenvector belongs to which oscillator: the largest shares first.
std::vector<Index> owners(const Eigen::MatrixXcd& vectors) {
  const Index size = vectors.rows();
  std::vector<Index> pairs(static_cast<std::size_t>(size * size));
  std::iota(pairs.begin(), pairs.end(), 0);
  const auto share = [&](Index pair) { return std::norm(vectors(pair % size, pair / size)); };
  std::ranges::stable_sort(pairs, [&](Index a, Index b) { return share(a) > share(b); });
  std::vector<Index> vector_of(static_cast<std::size_t>(size), -1);
  std::vector<bool> taken(static_cast<std::size_t>(size), false);
  for (const Index pair : pairs) {
    const Index oscillator = pair % size, vector = pair / size;
    if (vector_of[oscillator] >= 0 || taken[vector]) continue;
    vector_of[oscillator] = vector;
    taken[vector] = true;
  }
  return vector_of;
}

}  // namespace

CoupledModes coupled_modes(const Oscillators& oscillators) {
  const Index bars = oscillators.bar.size(), tubes = oscillators.tube.size(), size = bars + tubes;
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(size, size);
  matrix.diagonal() << oscillators.bar, oscillators.tube;
  matrix.topRightCorner(bars, tubes) = oscillators.bond;
  matrix.bottomLeftCorner(tubes, bars) = oscillators.bond.transpose();
  CoupledModes coupled;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const dense::ComplexSpectrum spectrum = dense::complex_spectrum(matrix);
    double least = 1;
    Eigen::MatrixXcd vectors = spectrum.vectors;
    for (Index n = 0; n < size; ++n) {
      const std::complex<double> square = vectors.col(n).cwiseAbs2().sum() > 0
                                              ? (vectors.col(n).transpose() * vectors.col(n)).value()
                                              : std::complex<double>(0);
      least = std::min(least, std::abs(square) / vectors.col(n).squaredNorm());
      vectors.col(n) /= std::sqrt(square);
    }
    if (least < kParallel) {
      matrix.diagonal().tail(tubes) *= 1 + kDetune;
      coupled.detuned = true;
      continue;
    }
    const std::vector<Index> vector_of = owners(vectors);
    coupled.omega_rad_s.resize(size);
    coupled.mixing.resize(size, size);
    for (Index n = 0; n < size; ++n) {
      coupled.omega_rad_s[n] = spectrum.values[vector_of[n]];
      coupled.mixing.col(n) = vectors.col(vector_of[n]);
      if (coupled.mixing(n, n).real() < 0) coupled.mixing.col(n) *= -1;
    }
    return coupled;
  }
  return coupled;
}

}  // namespace ringdown::tube
