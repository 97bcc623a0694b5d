// Random numbers for one hostile input: the same for the same seed, kind and index, whatever was drawn for others.
#pragma once

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <random>

namespace ringdown::hostile {

class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t kind, std::uint64_t index) {
    std::seed_seq numbers{seed, seed >> 32, kind, index, index >> 32};
    engine_.seed(numbers);
  }

  [[nodiscard]] std::mt19937_64& engine() { return engine_; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  bool one_in(std::size_t count) { return below(count) == 0; }
  double uniform(double low, double high) { return low + (high - low) * 0x1p-64 * static_cast<double>(engine_()); }
  // A power of ten with a random exponent.
  double power(double low_exponent, double high_exponent) {
    return std::pow(10.0, uniform(low_exponent, high_exponent));
  }
  template <class List>
  const auto& pick(const List& list) {
    return *(std::begin(list) + static_cast<std::ptrdiff_t>(below(std::size(list))));
  }

  // A finite number at an end of what a float or double holds, or one that is hard to divide by.
  double extreme() {
    static constexpr double kNumbers[] = {0.0,      -0.0, 1.0,   -1.0,  5e-324,  1e-300,   1e-45,       1e-39, 1e-20,
                                          1e-9,     1e6,  1e9,   1e12,  1e18,    1e24,     1e30,        -1e30, FLT_MAX,
                                          -FLT_MAX, 4e38, 1e100, 1e300, DBL_MAX, -DBL_MAX, 2147483648.0};
    return pick(kNumbers);
  }
  double no_number() { return one_in(2) ? std::numeric_limits<double>::quiet_NaN() : INFINITY * (one_in(2) ? 1 : -1); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ringdown::hostile
