#include "engine/radiate/wave_solver.h"

#include "engine/radiate/lanes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <utility>

extern "C" {
void cgetrf_(const int* rows, const int* columns, std::complex<float>* matrix, const int* stride, int* pivots,
             int* info);
void cgetrs_(const char* transposed, const int* size, const int* columns, const std::complex<float>* matrix,
             const int* stride, const int* pivots, std::complex<float>* right, const int* right_stride, int* info);
}

namespace ringdown::radiate {
namespace {

// One right-hand side of GMRES (Saad & Schultz 1986) for the preconditioned system. One rotation per step makes the
// Hessenberg matrix triangular, and the residual is the part of the right-hand side below the triangle.
struct Krylov {
  using Complex = std::complex<double>;
  std::vector<Eigen::VectorXcf> basis;
  Eigen::MatrixXcd triangle;
  Eigen::VectorXcd right;
  std::vector<std::pair<double, Complex>> rotations;  // cosine and sine
  double first = 0, residual = 0;
  bool done = false;

  explicit Krylov(int max_steps)
      : triangle(Eigen::MatrixXcd::Zero(max_steps + 1, max_steps)), right(Eigen::VectorXcd::Zero(max_steps + 1)) {}
  void start(const Eigen::VectorXcf& from, double wanted) {
    residual = wanted;
    first = from.norm();
    done = first == 0;
    right[0] = first;
    if (!done) basis.emplace_back(from / static_cast<float>(first));
  }
  void take(Eigen::VectorXcf next) {
    const int step = static_cast<int>(rotations.size());
    for (int l = 0; l <= step; ++l) {
      const std::complex<float> along = basis[l].dot(next);
      triangle(l, step) = Complex(along);
      next -= along * basis[l];
    }
    const double norm = next.norm();
    for (int l = 0; l < step; ++l) rotate(rotations[l], triangle(l, step), triangle(l + 1, step));
    const Complex above = triangle(step, step);
    const double length = std::hypot(std::abs(above), norm);
    const Complex phase = std::abs(above) > 0 ? above / std::abs(above) : Complex(1);
    rotations.emplace_back(std::abs(above) / length, phase * norm / length);
    triangle(step, step) = phase * length;
    rotate(rotations.back(), right[step], right[step + 1]);
    done = std::abs(right[step + 1]) <= residual * first || norm == 0;
    basis.emplace_back(norm > 0 ? Eigen::VectorXcf(next / static_cast<float>(norm)) : next);
  }
  static void rotate(const std::pair<double, Complex>& rotation, Complex& above, Complex& below) {
    const Complex old = above;
    above = rotation.first * above + rotation.second * below;
    below = rotation.first * below - std::conj(rotation.second) * old;
  }
  [[nodiscard]] Eigen::VectorXcf solution(Eigen::Index size) const {
    Eigen::VectorXcf sum = Eigen::VectorXcf::Zero(size);
    const auto steps = static_cast<Eigen::Index>(rotations.size());
    if (steps == 0) return sum;
    const Eigen::VectorXcd weights =
        triangle.topLeftCorner(steps, steps).triangularView<Eigen::Upper>().solve(right.head(steps));
    for (Eigen::Index l = 0; l < steps; ++l) sum += std::complex<float>(weights[l]) * basis[l];
    return sum;
  }
};

}  // namespace

// LAPACK stores matrices by columns, so it sees the transposed matrix.
LuFactors::LuFactors(ComplexMatrix& matrix) : factors_(matrix), pivots_(factors_.rows()) {
  const int size = static_cast<int>(factors_.rows());
  int info = 0;  // above 0: a pivot is exactly 0, which rounding rules out
  cgetrf_(&size, &size, factors_.data(), &size, pivots_.data(), &info);
}

Eigen::MatrixXcf LuFactors::solve(Eigen::MatrixXcf right) const {
  const int size = static_cast<int>(factors_.rows()), columns = static_cast<int>(right.cols());
  int info = 0;
  cgetrs_("T", &size, &columns, factors_.data(), &size, pivots_.data(), right.data(), &size, &info);
  return right;
}

namespace {

// Complex numbers as pairs of floats, stored twice. The first copy has negated imaginary parts; its products with a
// row, pair by pair, sum up to the real part of the complex product. The second copy has the parts exchanged and gives
// the imaginary part.
struct Columns {
  std::vector<float> real, imaginary;
};

Columns columns_of(const Eigen::MatrixXcf& matrix, Eigen::Index stride) {
  Columns columns{std::vector<float>(matrix.cols() * stride, 0.0F), std::vector<float>(matrix.cols() * stride, 0.0F)};
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (Eigen::Index n = 0; n < matrix.rows(); ++n) {
      const std::complex<float> value = matrix(n, c);
      const Eigen::Index at = c * stride + 2 * n;
      columns.real[at] = value.real();
      columns.real[at + 1] = -value.imag();
      columns.imaginary[at] = value.imag();
      columns.imaginary[at + 1] = value.real();
    }
  }
  return columns;
}

// Two rows of the matrix times `count` columns.
template <int count>
[[gnu::always_inline]] inline void multiply_rows(const float* first, const float* second, Eigen::Index floats,
                                                 const float* real, const float* imaginary, Eigen::Index stride,
                                                 std::complex<float>* out, Eigen::Index out_stride, bool both) {
  Lanes sums[2][2][count]{};
  for (Eigen::Index at = 0; at < floats; at += kLanes) {
    Lanes a{}, b{};
    const std::size_t size = sizeof(float) * std::min<Eigen::Index>(kLanes, floats - at);
    if (size == sizeof a) {
      std::memcpy(&a, first + at, sizeof a);
      std::memcpy(&b, second + at, sizeof b);
    } else {
      std::memcpy(&a, first + at, size);
      std::memcpy(&b, second + at, size);
    }
    for (int c = 0; c < count; ++c) {
      Lanes re, im;
      std::memcpy(&re, real + c * stride + at, sizeof re);
      std::memcpy(&im, imaginary + c * stride + at, sizeof im);
      sums[0][0][c] += a * re;
      sums[0][1][c] += a * im;
      sums[1][0][c] += b * re;
      sums[1][1][c] += b * im;
    }
  }
  for (int c = 0; c < count; ++c) {
    for (int row = 0; row < (both ? 2 : 1); ++row) {
      float re = 0, im = 0;
      for (int lane = 0; lane < kLanes; ++lane) {
        re += sums[row][0][c][lane];
        im += sums[row][1][c][lane];
      }
      out[c * out_stride + row] = {re, im};
    }
  }
}

RINGDOWN_CLONES
void multiply_all(const float* matrix, Eigen::Index nodes, const float* real, const float* imaginary,
                  Eigen::Index stride, int count, std::complex<float>* out) {
  for (Eigen::Index row = 0; row < nodes; row += 2) {
    const bool both = row + 1 < nodes;
    const float *const first = matrix + 2 * nodes * row, *const second = both ? first + 2 * nodes : first;
    switch (count) {
      case 1:
        multiply_rows<1>(first, second, 2 * nodes, real, imaginary, stride, out + row, nodes, both);
        break;
      case 2:
        multiply_rows<2>(first, second, 2 * nodes, real, imaginary, stride, out + row, nodes, both);
        break;
      case 3:
        multiply_rows<3>(first, second, 2 * nodes, real, imaginary, stride, out + row, nodes, both);
        break;
      default:
        multiply_rows<4>(first, second, 2 * nodes, real, imaginary, stride, out + row, nodes, both);
        break;
    }
  }
}

}  // namespace

// The matrix is read once for four columns, because reading it takes most of the time.
Eigen::MatrixXcf multiply(const ComplexMatrix& matrix, const Eigen::MatrixXcf& columns) {
  constexpr int kAtOnce = 4;
  const Eigen::Index nodes = matrix.rows(), stride = (2 * nodes + kLanes - 1) / kLanes * kLanes;
  const Columns parts = columns_of(columns, stride);
  Eigen::MatrixXcf product(nodes, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); c += kAtOnce) {
    const int count = static_cast<int>(std::min<Eigen::Index>(kAtOnce, columns.cols() - c));
    multiply_all(reinterpret_cast<const float*>(matrix.data()), nodes, parts.real.data() + c * stride,
                 parts.imaginary.data() + c * stride, stride, count, product.col(c).data());
  }
  return product;
}

Eigen::MatrixXcf iterate(const ComplexMatrix& matrix, const Eigen::MatrixXcf& flow,
                         const std::vector<double>& residuals, const Preconditioner& precondition, int max_steps,
                         const std::function<bool()>& go_on) {
  const Eigen::MatrixXcf right = precondition(flow);
  std::vector<Krylov> columns(flow.cols(), Krylov(max_steps));
  for (Eigen::Index m = 0; m < flow.cols(); ++m) columns[m].start(right.col(m), residuals[m]);
  for (int step = 0;; ++step) {
    std::vector<Eigen::Index> active;
    for (Eigen::Index m = 0; m < flow.cols(); ++m) {
      if (!columns[m].done) active.push_back(m);
    }
    if (active.empty()) break;
    if (step == max_steps || !go_on()) return {};
    Eigen::MatrixXcf last(flow.rows(), static_cast<Eigen::Index>(active.size()));
    for (Eigen::Index a = 0; a < last.cols(); ++a) last.col(a) = columns[active[a]].basis.back();
    const Eigen::MatrixXcf next = precondition(multiply(matrix, last));
    for (Eigen::Index a = 0; a < last.cols(); ++a) columns[active[a]].take(next.col(a));
  }
  Eigen::MatrixXcf layers(flow.rows(), flow.cols());
  for (Eigen::Index m = 0; m < flow.cols(); ++m) layers.col(m) = columns[m].solution(flow.rows());
  return layers;
}

}  // namespace ringdown::radiate
