// The classical method of Runge and Kutta of order four.
#pragma once

#include <array>
#include <cstddef>

namespace ringdown::test {

template <std::size_t N, class Slope>
std::array<double, N> runge_kutta(std::array<double, N> x, double from, double to, int steps, const Slope& slope) {
  const double h = (to - from) / steps;
  const auto moved = [](const std::array<double, N>& start, double by, const std::array<double, N>& along) {
    std::array<double, N> end = start;
    for (std::size_t i = 0; i < N; ++i) end[i] += by * along[i];
    return end;
  };
  for (int step = 0; step < steps; ++step) {
    const double t = from + h * step;
    const std::array<double, N> k1 = slope(t, x), k2 = slope(t + h / 2, moved(x, h / 2, k1)),
                                k3 = slope(t + h / 2, moved(x, h / 2, k2)), k4 = slope(t + h, moved(x, h, k3));
    for (std::size_t i = 0; i < N; ++i) x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return x;
}

}  // namespace ringdown::test
