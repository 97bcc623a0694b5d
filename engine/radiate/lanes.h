// Sixteen numbers at once, in GCC's and clang's vector extension. [any thread]
//
// RINGDOWN_CLONES compiles a function for several instruction sets; the loader chooses the one that fits the processor.
#pragma once

#include <utility>

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GNUC__) && \
    !defined(__clang__)
#define RINGDOWN_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define RINGDOWN_CLONES
#endif

namespace ringdown::radiate {

constexpr int kLanes = 16;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using LaneInts = int __attribute__((vector_size(kLanes * sizeof(int))));

struct alignas(64) Complexes {
  Lanes re, im;
};

// exp(i x) to 2e-7, for x from 0 to about 10,000. The nearest multiple of pi/2 is subtracted in two parts, and sine and
// cosine of the rest are Taylor polynomials (minimax coefficients: Cephes, sinf.c and cosf.c).
[[gnu::always_inline]] inline void exp_i(const Lanes& x, Lanes& cosine, Lanes& sine) {
  const Lanes magic = Lanes{} + 12582912.0F;  // 1.5 * 2^23: adding it rounds to a whole number, in the lowest bits
  const Lanes shifted = x * 0.636619772F + magic;
  const Lanes whole = shifted - magic;
  const LaneInts quadrant = __builtin_bit_cast(LaneInts, shifted);
  Lanes r = x - whole * 1.5703125F;
  r = r - whole * 4.837512969970703125e-4F;
  r = r - whole * 7.54978995489188216e-8F;
  const Lanes r2 = r * r;
  const Lanes s = ((-1.9515295891e-4F * r2 + 8.3321608736e-3F) * r2 - 1.6666654611e-1F) * r2 * r + r;
  const Lanes c =
      ((2.443315711809948e-5F * r2 - 1.388731625493765e-3F) * r2 + 4.166664568298827e-2F) * r2 * r2 - 0.5F * r2 + 1.0F;
  const LaneInts odd = -(quadrant & 1);
  const LaneInts sb = __builtin_bit_cast(LaneInts, s), cb = __builtin_bit_cast(LaneInts, c);
  LaneInts sine_bits = (sb & ~odd) | (cb & odd), cosine_bits = (cb & ~odd) | (sb & odd);
  sine_bits ^= (quadrant & 2) << 30;
  cosine_bits ^= ((quadrant + 1) & 2) << 30;
  sine = __builtin_bit_cast(Lanes, sine_bits);
  cosine = __builtin_bit_cast(Lanes, cosine_bits);
}

[[gnu::always_inline]] inline void square_root(const Lanes& x, Lanes& root) {
  for (int i = 0; i < kLanes; ++i) root[i] = __builtin_sqrtf(x[i]);
}

// One step of a transposition. `out` gets the lanes of `a` whose number has the bit `step` clear; every other lane n
// gets lane n - step of `b`. With `upper`, `out` gets the lanes of `b` whose number has the bit set; every other lane n
// gets lane n + step of `a`.
template <int step, bool upper, int... lane>
[[gnu::always_inline]] inline void exchange(const Lanes& a, const Lanes& b, Lanes& out,
                                            std::integer_sequence<int, lane...> /*lanes*/) {
  if constexpr (upper) {
    out = __builtin_shufflevector(a, b, ((lane & step) != 0 ? kLanes + lane : lane + step)...);
  } else {
    out = __builtin_shufflevector(a, b, ((lane & step) == 0 ? lane : kLanes + lane - step)...);
  }
}

template <int step>
[[gnu::always_inline]] inline void exchange_all(Lanes (&rows)[kLanes]) {
  constexpr std::make_integer_sequence<int, kLanes> lanes;
  for (int first = 0; first < kLanes; ++first) {
    if ((first & step) != 0) continue;
    const Lanes a = rows[first], b = rows[first + step];
    exchange<step, false>(a, b, rows[first], lanes);
    exchange<step, true>(a, b, rows[first + step], lanes);
  }
}

// Exchanges rows and columns.
[[gnu::always_inline]] inline void transpose(Lanes (&rows)[kLanes]) {
  exchange_all<1>(rows);
  exchange_all<2>(rows);
  exchange_all<4>(rows);
  exchange_all<8>(rows);
}

}  // namespace ringdown::radiate
