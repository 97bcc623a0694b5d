#include "engine/modal/levels/symmetric_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

// Householder's reflections make the matrix tridiagonal, and implicit QL steps make that diagonal (Bowdler, Martin,
// Reinsch & Wilkinson, Numer. Math. 11 (1968) 293: tred2 and tql2).
namespace ringdown::modal {
namespace {

// The matrix with its reflections on one side, diagonal and subdiagonal on the other.
struct Tridiagonal {
  std::size_t n;
  std::vector<double> v;     // n x n: first the matrix, then the product of the reflections
  std::vector<double> d, e;  // diagonal; e[i] lies between i - 1 and i

  double& at(std::size_t row, std::size_t column) { return v[row * n + column]; }
};

// Reflects row i, so that only the element beside the diagonal is left of it.
void reflect_row(Tridiagonal& t, std::size_t i) {
  double scale = 0;
  for (std::size_t k = 0; k < i; ++k) scale += std::abs(t.at(i, k));
  if (i == 1 || scale == 0) {
    t.e[i] = t.at(i, i - 1);
    t.d[i] = 0;
    return;
  }
  double h = 0;
  for (std::size_t k = 0; k < i; ++k) {
    t.at(i, k) /= scale;
    h += t.at(i, k) * t.at(i, k);
  }
  const double f = t.at(i, i - 1), g = f > 0 ? -std::sqrt(h) : std::sqrt(h);
  t.e[i] = scale * g;
  h -= f * g;
  t.at(i, i - 1) = f - g;
  double sum = 0;
  for (std::size_t j = 0; j < i; ++j) {
    t.at(j, i) = t.at(i, j) / h;
    double product = 0;
    for (std::size_t k = 0; k <= j; ++k) product += t.at(j, k) * t.at(i, k);
    for (std::size_t k = j + 1; k < i; ++k) product += t.at(k, j) * t.at(i, k);
    t.e[j] = product / h;
    sum += t.e[j] * t.at(i, j);
  }
  const double half = sum / (h + h);
  for (std::size_t j = 0; j < i; ++j) {
    const double own = t.at(i, j), pull = t.e[j] - half * own;
    t.e[j] = pull;
    for (std::size_t k = 0; k <= j; ++k) t.at(j, k) -= own * t.e[k] + pull * t.at(i, k);
  }
  t.d[i] = h;
}

// Multiplies the reflections.
void collect(Tridiagonal& t) {
  t.d[0] = t.e[0] = 0;
  for (std::size_t i = 0; i < t.n; ++i) {
    if (t.d[i] != 0) {
      for (std::size_t j = 0; j < i; ++j) {
        double product = 0;
        for (std::size_t k = 0; k < i; ++k) product += t.at(i, k) * t.at(k, j);
        for (std::size_t k = 0; k < i; ++k) t.at(k, j) -= product * t.at(k, i);
      }
    }
    t.d[i] = t.at(i, i);
    t.at(i, i) = 1;
    for (std::size_t j = 0; j < i; ++j) t.at(j, i) = t.at(i, j) = 0;
  }
}

// One implicit QL step from `first` to `last`, between which the matrix does not fall apart.
void step(Tridiagonal& t, std::size_t first, std::size_t last) {
  double g = (t.d[first + 1] - t.d[first]) / (2 * t.e[first]);
  const double r = std::hypot(g, 1.0);
  g = t.d[last] - t.d[first] + t.e[first] / (g + (g < 0 ? -r : r));
  double sine = 1, cosine = 1, p = 0;
  for (std::size_t i = last; i-- > first;) {
    const double f = sine * t.e[i], b = cosine * t.e[i], length = std::hypot(f, g);
    t.e[i + 1] = length;
    if (length == 0) {
      t.d[i + 1] -= p;
      t.e[last] = 0;
      return;
    }
    sine = f / length;
    cosine = g / length;
    g = t.d[i + 1] - p;
    const double turn = (t.d[i] - g) * sine + 2 * cosine * b;
    p = sine * turn;
    t.d[i + 1] = g + p;
    g = cosine * turn - b;
    // The rows of `v` are the columns of the eigenvectors here, so that both lie in a row.
    double *const low = &t.v[i * t.n], *const high = low + t.n;
    for (std::size_t k = 0; k < t.n; ++k) {
      const double upper = high[k];
      high[k] = sine * low[k] + cosine * upper;
      low[k] = cosine * low[k] - sine * upper;
    }
  }
  t.d[first] -= p;
  t.e[first] = g;
  t.e[last] = 0;
}

void diagonalize(Tridiagonal& t) {
  constexpr int kMaxSteps = 60;  // for each eigenvalue; 2 is usual
  constexpr double kSmall = std::numeric_limits<double>::epsilon();
  for (std::size_t first = 0; first < t.n; ++first) {
    for (int steps = 0; steps < kMaxSteps; ++steps) {
      std::size_t last = first;
      while (last + 1 < t.n && std::abs(t.e[last]) > kSmall * (std::abs(t.d[last]) + std::abs(t.d[last + 1]))) ++last;
      if (last == first) break;
      step(t, first, last);
    }
  }
}

// Puts L with L L^T = a into the lower triangle of a. Returns false when a is not positive definite.
bool cholesky(std::vector<double>& a, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      if (j < i) {
        a[i * n + j] = sum / a[j * n + j];
      } else if (sum > 0) {
        a[i * n + i] = std::sqrt(sum);
      } else {
        return false;
      }
    }
  }
  return true;
}

// b := L^-1 b, for b of n x columns.
void solve_lower(const std::vector<double>& lower, std::size_t n, std::vector<double>& b, std::size_t columns) {
  for (std::size_t i = 0; i < n; ++i) {
    double* const row = &b[i * columns];
    for (std::size_t k = 0; k < i; ++k) {
      const double factor = lower[i * n + k], *const above = &b[k * columns];
      for (std::size_t c = 0; c < columns; ++c) row[c] -= factor * above[c];
    }
    for (std::size_t c = 0; c < columns; ++c) row[c] /= lower[i * n + i];
  }
}

// b := L^-T b.
void solve_upper(const std::vector<double>& lower, std::size_t n, std::vector<double>& b, std::size_t columns) {
  for (std::size_t i = n; i-- > 0;) {
    double* const row = &b[i * columns];
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = lower[k * n + i], *const below = &b[k * columns];
      for (std::size_t c = 0; c < columns; ++c) row[c] -= factor * below[c];
    }
    for (std::size_t c = 0; c < columns; ++c) row[c] /= lower[i * n + i];
  }
}

void transpose(std::vector<double>& a, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) std::swap(a[i * n + j], a[j * n + i]);
  }
}

}  // namespace

SymmetricSpectrum symmetric_spectrum(std::vector<double> matrix, std::size_t n) {
  Tridiagonal t{n, std::move(matrix), std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = n; i-- > 1;) reflect_row(t, i);
  if (n > 0) collect(t);
  transpose(t.v, n);
  if (n > 0) std::rotate(t.e.begin(), t.e.begin() + 1, t.e.end());  // now e[i] lies between i and i + 1
  diagonalize(t);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return t.d[k]; });
  SymmetricSpectrum spectrum{std::vector<double>(n), std::vector<double>(n * n)};
  for (std::size_t k = 0; k < n; ++k) {
    spectrum.values[k] = t.d[order[k]];
    for (std::size_t i = 0; i < n; ++i) spectrum.vectors[i * n + k] = t.at(order[k], i);
  }
  return spectrum;
}

std::optional<SymmetricSpectrum> generalized_spectrum(std::vector<double> stiffness, std::vector<double> mass,
                                                      std::size_t n) {
  if (!cholesky(mass, n)) return std::nullopt;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) stiffness[j * n + i] = stiffness[i * n + j];
  }
  solve_lower(mass, n, stiffness, n);
  transpose(stiffness, n);
  solve_lower(mass, n, stiffness, n);
  SymmetricSpectrum spectrum = symmetric_spectrum(std::move(stiffness), n);
  solve_upper(mass, n, spectrum.vectors, n);
  return spectrum;
}

bool is_positive_definite(std::vector<double> matrix, std::size_t n) { return cholesky(matrix, n); }

std::vector<double> transposed_product(std::span<const double> a, std::span<const double> b, std::size_t rows) {
  const std::size_t m = a.size() / rows, columns = b.size() / rows;
  std::vector<double> result(m * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < m; ++i) {
      const double factor = a[row * m + i];
      if (factor == 0) continue;
      for (std::size_t c = 0; c < columns; ++c) result[i * columns + c] += factor * b[row * columns + c];
    }
  }
  return result;
}

std::vector<double> product(std::span<const double> a, std::span<const double> b, std::size_t inner) {
  const std::size_t m = a.size() / inner, columns = b.size() / inner;
  std::vector<double> result(m * columns);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t k = 0; k < inner; ++k) {
      const double factor = a[i * inner + k];
      if (factor == 0) continue;
      for (std::size_t c = 0; c < columns; ++c) result[i * columns + c] += factor * b[k * columns + c];
    }
  }
  return result;
}

}  // namespace ringdown::modal
