// Blocks of kWidth vectors, side by side, and arithmetic on blocks. Private to engine/solve. [any thread]
//
// Entry (unknown u, vector v) of a block is stored at [u * kWidth + v], so that a few wide instructions process one
// unknown of all vectors. RINGDOWN_CLONES compiles a function for several instruction sets; the loader chooses the one
// that fits the processor.
#pragma once

#include <Eigen/Core>

namespace ringdown::solve {

inline constexpr int kWidth = 8;
using Block = Eigen::Matrix<double, kWidth, Eigen::Dynamic>;  // kWidth x 3N: one column per unknown
using Small = Eigen::Matrix<double, kWidth, kWidth>;

#if defined(__x86_64__) && defined(__gnu_linux__)
#define RINGDOWN_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define RINGDOWN_CLONES
#endif

using Lanes = double __attribute__((vector_size(kWidth * sizeof(double)), aligned(8), may_alias));

inline Lanes* lanes(double* x, std::ptrdiff_t unknown = 0) { return reinterpret_cast<Lanes*>(x + unknown * kWidth); }
inline const Lanes* lanes(const double* x, std::ptrdiff_t unknown = 0) {
  return reinterpret_cast<const Lanes*>(x + unknown * kWidth);
}

// Adds y x^T to `sum`: the inner products of all vectors of y with all of x, over `unknowns` (column-major, one row per
// vector of y).
void add_inner_products(const double* y, const double* x, std::ptrdiff_t unknowns, Small& sum);

// x -= factors^T y: subtracts combinations of y's vectors from x.
void subtract_combination(const double* y, const Small& factors, double* x, std::ptrdiff_t unknowns);

// x := factors x.
void combine_in_place(const Small& factors, double* x, std::ptrdiff_t unknowns);

}  // namespace ringdown::solve
