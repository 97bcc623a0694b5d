// Eigenvalues of small symmetric matrices in the real-time half, which has no Eigen. [any thread]
//
// Matrices are n x n, stored row by row. The time is about 10 n^3 operations: 3 ms for n = 80.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::modal {

struct SymmetricSpectrum {
  std::vector<double> values;   // n, ascending
  std::vector<double> vectors;  // n x n: eigenvector k is column k
};

// Eigenvectors are orthonormal. Only the lower triangle of the matrix counts.
SymmetricSpectrum symmetric_spectrum(std::vector<double> matrix, std::size_t n);

// Solves stiffness x = lambda mass x, with x^T mass x = 1. Empty when the mass is not positive definite.
std::optional<SymmetricSpectrum> generalized_spectrum(std::vector<double> stiffness, std::vector<double> mass,
                                                      std::size_t n);

// Only the lower triangle of the matrix counts.
bool is_positive_definite(std::vector<double> matrix, std::size_t n);

// Returns a^T b, for a of rows x m and b of rows x k: m x k.
std::vector<double> transposed_product(std::span<const double> a, std::span<const double> b, std::size_t rows);

// Returns a b, for a of m x inner and b of inner x k: m x k.
std::vector<double> product(std::span<const double> a, std::span<const double> b, std::size_t inner);

}  // namespace ringdown::modal
