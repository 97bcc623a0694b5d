#include "engine/dense/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

extern "C" {  // LAPACK
void dgeqrf_(const int* m, const int* n, double* a, const int* lda, double* tau, double* work, const int* lwork,
             int* info);
void dorgqr_(const int* m, const int* n, const int* k, double* a, const int* lda, const double* tau, double* work,
             const int* lwork, int* info);
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* values,
             double* work, const int* lwork, int* iwork, const int* liwork, int* info);
void dpotrf_(const char* triangle, const int* n, double* a, const int* lda, int* info);
void spotrf_(const char* triangle, const int* n, float* a, const int* lda, int* info);
void spotrs_(const char* triangle, const int* n, const int* columns, const float* a, const int* lda, float* b,
             const int* ldb, int* info);
void zpotrf_(const char* triangle, const int* n, std::complex<double>* a, const int* lda, int* info);
void zpotrs_(const char* triangle, const int* n, const int* columns, const std::complex<double>* a, const int* lda,
             std::complex<double>* b, const int* ldb, int* info);
void dgetrf_(const int* m, const int* n, double* a, const int* lda, int* pivots, int* info);
void zgeev_(const char* left, const char* right, const int* n, std::complex<double>* a, const int* lda,
            std::complex<double>* values, std::complex<double>* left_vectors, const int* ldl,
            std::complex<double>* vectors, const int* ldr, std::complex<double>* work, const int* lwork, double* rwork,
            int* info);
void zheevd_(const char* job, const char* triangle, const int* n, std::complex<double>* a, const int* lda,
             double* values, std::complex<double>* work, const int* lwork, double* rwork, const int* lrwork, int* iwork,
             const int* liwork, int* info);
void zgelsy_(const int* m, const int* n, const int* columns, std::complex<double>* a, const int* lda,
             std::complex<double>* b, const int* ldb, int* pivots, const double* precision, int* rank,
             std::complex<double>* work, const int* lwork, double* rwork, int* info);
void dgetri_(const int* n, double* a, const int* lda, const int* pivots, double* work, const int* lwork, int* info);
}

namespace ringdown::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kBlock = 64;  // columns at once; LAPACK is fastest with this number

// Eigenvalues of n x n numbers, which become the eigenvectors if those are asked for. LAPACK may not end on NaN.
VectorXd solve_spectrum(MatrixXd& a, bool vectors) {
  const auto n = static_cast<int>(a.rows());
  if (n == 0) return {};
  VectorXd values = VectorXd::Constant(n, kNan);
  int info = 1;
  if (a.allFinite()) {
    const int work_size = vectors ? 1 + 6 * n + 2 * n * n : 2 * n + 1, iwork_size = vectors ? 3 + 5 * n : 1;
    std::vector<double> work(static_cast<std::size_t>(work_size));
    std::vector<int> iwork(static_cast<std::size_t>(iwork_size));
    dsyevd_(vectors ? "V" : "N", "L", &n, a.data(), &n, values.data(), work.data(), &work_size, iwork.data(),
            &iwork_size, &info);
  }
  if (info != 0) {
    values.setConstant(kNan);
    a.setConstant(kNan);
  }
  return values;
}

// Calls LAPACK's ?potrf for any type of numbers.
template <class Potrf, class Matrix>
bool factored(Potrf potrf, Matrix& a) {
  const auto n = static_cast<int>(a.rows());
  int info = 0;
  if (n > 0) potrf("L", &n, a.data(), &n, &info);
  return info == 0;
}

// Calls LAPACK's ?potrs for any type of numbers.
template <class Potrs, class Matrix, class Columns>
void solve_factored(Potrs potrs, const Matrix& lower, Columns& b) {
  const auto n = static_cast<int>(lower.rows()), columns = static_cast<int>(b.cols());
  int info = 0;
  if (n > 0 && columns > 0) potrs("L", &n, &columns, lower.data(), &n, b.data(), &n, &info);
}

}  // namespace

Spectrum spectrum(const MatrixXd& symmetric) {
  Spectrum solved{.values = {}, .vectors = symmetric};
  solved.values = solve_spectrum(solved.vectors, true);
  return solved;
}

Spectrum3 spectrum_of_3(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(symmetric);
  return {solved.eigenvalues(), solved.eigenvectors()};
}

VectorXd eigenvalues(const MatrixXd& symmetric) {
  MatrixXd a = symmetric;
  return solve_spectrum(a, false);
}

HermitianSpectrum hermitian_spectrum(Eigen::MatrixXcd matrix) {
  const auto n = static_cast<int>(matrix.rows());
  VectorXd values = VectorXd::Constant(n, kNan);
  int info = 1;
  if (n > 0 && matrix.allFinite()) {
    const int work_size = (2 + kBlock) * n + n * n, real_size = 1 + 5 * n + 2 * n * n, whole_size = 3 + 5 * n;
    std::vector<std::complex<double>> work(static_cast<std::size_t>(work_size));
    std::vector<double> real_work(static_cast<std::size_t>(real_size));
    std::vector<int> whole_work(static_cast<std::size_t>(whole_size));
    zheevd_("V", "L", &n, matrix.data(), &n, values.data(), work.data(), &work_size, real_work.data(), &real_size,
            whole_work.data(), &whole_size, &info);
  }
  if (info != 0) {
    values.setConstant(kNan);
    matrix.setConstant(kNan);
  }
  return {std::move(values), std::move(matrix)};
}

ComplexSpectrum complex_spectrum(Eigen::MatrixXcd matrix) {
  const auto n = static_cast<int>(matrix.rows());
  ComplexSpectrum solved{Eigen::VectorXcd::Constant(n, kNan), Eigen::MatrixXcd::Constant(n, n, kNan)};
  if (n == 0 || !matrix.allFinite()) return solved;
  const int work_size = kBlock * n, one = 1;
  std::vector<std::complex<double>> work(static_cast<std::size_t>(work_size));
  std::vector<double> real_work(2 * static_cast<std::size_t>(n));
  int info = 0;
  zgeev_("N", "V", &n, matrix.data(), &n, solved.values.data(), nullptr, &one, solved.vectors.data(), &n, work.data(),
         &work_size, real_work.data(), &info);
  if (info != 0) solved.values.setConstant(kNan);
  return solved;
}

// With mass = L L^T: the spectrum of L^-1 stiffness L^-T, its vectors times L^-T.
std::optional<Spectrum> generalized_spectrum(const MatrixXd& stiffness, const MatrixXd& mass) {
  MatrixXd lower = mass;
  if (!cholesky(lower)) return std::nullopt;
  MatrixXd whole = stiffness.selfadjointView<Eigen::Lower>();
  solve_lower(lower, whole);
  divide_by_upper(lower, whole);
  Spectrum solved = spectrum(whole);
  if (!solved.values.allFinite()) return std::nullopt;
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(solved.vectors);
  return solved;
}

bool cholesky(MatrixXd& a) { return factored(dpotrf_, a); }
bool cholesky(Eigen::MatrixXf& a) { return factored(spotrf_, a); }
bool cholesky(Eigen::MatrixXcd& a) { return factored(zpotrf_, a); }

void solve_cholesky(const Eigen::MatrixXf& lower, Eigen::MatrixXf& b) { solve_factored(spotrs_, lower, b); }
void solve_cholesky(const Eigen::MatrixXcd& lower, Eigen::VectorXcd& b) { solve_factored(zpotrs_, lower, b); }

void solve_lower(const MatrixXd& lower, MatrixXd& b) { lower.triangularView<Eigen::Lower>().solveInPlace(b); }
void solve_lower(const Eigen::MatrixXcd& lower, Eigen::MatrixXcd& b) {
  lower.triangularView<Eigen::Lower>().solveInPlace(b);
}

void divide_by_upper(const MatrixXd& lower, MatrixXd& b) {
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(b);
}

MatrixXd solve_symmetric(const MatrixXd& a, const MatrixXd& b) { return Eigen::LDLT<MatrixXd>(a).solve(b); }

Eigen::MatrixXcd least_squares(Eigen::MatrixXcd a, Eigen::MatrixXcd b) {
  constexpr double kPrecision = std::numeric_limits<double>::epsilon();
  const auto rows = static_cast<int>(a.rows()), columns = static_cast<int>(a.cols()),
             sides = static_cast<int>(b.cols());
  if (columns == 0 || !a.allFinite()) return Eigen::MatrixXcd::Constant(columns, sides, kNan);
  const int work_size = columns + kBlock * (columns + std::max(columns, sides));
  std::vector<int> pivots(static_cast<std::size_t>(columns));
  std::vector<std::complex<double>> work(static_cast<std::size_t>(work_size));
  std::vector<double> real_work(2 * static_cast<std::size_t>(columns));
  int rank = 0, info = 0;
  zgelsy_(&rows, &columns, &sides, a.data(), &rows, b.data(), &rows, pivots.data(), &kPrecision, &rank, work.data(),
          &work_size, real_work.data(), &info);
  return b.topRows(columns);
}

MatrixXd inverse(const MatrixXd& a) {
  MatrixXd inverted = a;
  const auto n = static_cast<int>(a.rows());
  if (n == 0) return inverted;
  const int work_size = kBlock * n;
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> pivots(static_cast<std::size_t>(n));
  int info = 0;
  dgetrf_(&n, &n, inverted.data(), &n, pivots.data(), &info);
  if (info == 0) dgetri_(&n, inverted.data(), &n, pivots.data(), work.data(), &work_size, &info);
  if (info != 0) inverted.setConstant(kNan);
  return inverted;
}

MatrixXd orthonormal_basis(MatrixXd columns) {
  const auto m = static_cast<int>(columns.rows()), n = static_cast<int>(columns.cols());
  const int work_size = kBlock * n;
  std::vector<double> tau(static_cast<std::size_t>(n)), work(static_cast<std::size_t>(work_size));
  int info = 0;
  dgeqrf_(&m, &n, columns.data(), &m, tau.data(), work.data(), &work_size, &info);
  dorgqr_(&m, &n, &n, columns.data(), &m, tau.data(), work.data(), &work_size, &info);
  return columns;
}

}  // namespace ringdown::dense
