#include "engine/modal/levels/level_spline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace ringdown::modal {

std::vector<double> spline_shares(const std::vector<double>& at, double x) {
  const std::size_t n = at.size();
  std::size_t i = 0;
  while (i + 2 < n && x > at[i + 1]) ++i;
  const double width = at[i + 1] - at[i], a = (at[i + 1] - x) / width, b = (x - at[i]) / width;
  std::vector<double> shares(n), pull(n);
  shares[i] = a;
  shares[i + 1] = b;
  pull[i] = (a * a * a - a) * width * width / 6;
  pull[i + 1] = (b * b * b - b) * width * width / 6;
  // The second derivatives s solve T s = Q y. Their shares are Q^T T^-T pull; `rows` holds T^T beside pull.
  std::vector<double> system(n * n), right(n * n);
  const auto t = [&](std::size_t row, std::size_t column) -> double& { return system[column * n + row]; };
  const auto q = [&](std::size_t row, std::size_t column) -> double& { return right[row * n + column]; };
  const auto h = [&](std::size_t k) { return at[k + 1] - at[k]; };
  t(0, 0) = h(0) / 3, t(0, 1) = h(0) / 6;
  q(0, 0) = -1 / h(0), q(0, 1) = 1 / h(0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    t(k, k - 1) = h(k - 1) / 6, t(k, k) = (h(k - 1) + h(k)) / 3, t(k, k + 1) = h(k) / 6;
    q(k, k - 1) = 1 / h(k - 1), q(k, k) = -1 / h(k - 1) - 1 / h(k), q(k, k + 1) = 1 / h(k);
  }
  t(n - 1, n - 3) = 1 / h(n - 3), t(n - 1, n - 2) = -1 / h(n - 3) - 1 / h(n - 2), t(n - 1, n - 1) = 1 / h(n - 2);
  for (std::size_t k = 0; k < n; ++k) {  // Gauss's elimination of T^T z = pull
    std::size_t pivot = k;
    for (std::size_t row = k + 1; row < n; ++row) {
      if (std::abs(system[row * n + k]) > std::abs(system[pivot * n + k])) pivot = row;
    }
    for (std::size_t c = 0; c < n; ++c) std::swap(system[k * n + c], system[pivot * n + c]);
    std::swap(pull[k], pull[pivot]);
    for (std::size_t row = k + 1; row < n; ++row) {
      const double factor = system[row * n + k] / system[k * n + k];
      if (factor == 0) continue;
      for (std::size_t c = k; c < n; ++c) system[row * n + c] -= factor * system[k * n + c];
      pull[row] -= factor * pull[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t c = k + 1; c < n; ++c) pull[k] -= system[k * n + c] * pull[c];
    pull[k] /= system[k * n + k];
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t c = 0; c < n; ++c) shares[c] += pull[k] * q(k, c);
  }
  return shares;
}

}  // namespace ringdown::modal
