#include "engine/solve/lanes.h"

namespace ringdown::solve {
namespace {

constexpr int kAhead = 256;  // doubles of y that are prefetched ahead of their use

// sum := the sum of kWidth columns, each multiplied by its value.
[[gnu::always_inline]] inline void multiply(const double* value, const Lanes* columns, Lanes& sum) {
  Lanes a = value[0] * columns[0], b = value[1] * columns[1];
  for (int i = 2; i < kWidth; i += 2) {
    a += value[i] * columns[i];
    b += value[i + 1] * columns[i + 1];
  }
  sum = a + b;
}

}  // namespace

RINGDOWN_CLONES
void add_inner_products(const double* y, const double* x, std::ptrdiff_t unknowns, Small& sum) {
  Lanes columns[kWidth];
  for (int j = 0; j < kWidth; ++j) columns[j] = *lanes(sum.data(), j);
  for (std::ptrdiff_t u = 0; u < unknowns; ++u) {
    __builtin_prefetch(y + u * kWidth + kAhead);
    const Lanes value = *lanes(y, u);
    const double* factor = x + u * kWidth;
    for (int j = 0; j < kWidth; ++j) columns[j] += factor[j] * value;
  }
  for (int j = 0; j < kWidth; ++j) *lanes(sum.data(), j) = columns[j];
}

RINGDOWN_CLONES
void subtract_combination(const double* y, const Small& factors, double* x, std::ptrdiff_t unknowns) {
  const Small by_vector = factors.transpose();  // column i: the factors of y's vector i in each vector of x
  Lanes columns[kWidth];
  for (int i = 0; i < kWidth; ++i) columns[i] = *lanes(by_vector.data(), i);
  for (std::ptrdiff_t u = 0; u < unknowns; ++u) {
    __builtin_prefetch(y + u * kWidth + kAhead);
    Lanes sum;
    multiply(y + u * kWidth, columns, sum);
    *lanes(x, u) -= sum;
  }
}

RINGDOWN_CLONES
void combine_in_place(const Small& factors, double* x, std::ptrdiff_t unknowns) {
  Lanes columns[kWidth];
  for (int i = 0; i < kWidth; ++i) columns[i] = *lanes(factors.data(), i);
  for (std::ptrdiff_t u = 0; u < unknowns; ++u) multiply(x + u * kWidth, columns, *lanes(x, u));
}

}  // namespace ringdown::solve
