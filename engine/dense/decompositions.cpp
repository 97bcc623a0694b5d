#include "engine/dense/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <utility>
#include <vector>

extern "C" {  // LAPACK
void dgeqrf_(const int* m, const int* n, double* a, const int* lda, double* tau, double* work, const int* lwork,
             int* info);
void dorgqr_(const int* m, const int* n, const int* k, double* a, const int* lda, const double* tau, double* work,
             const int* lwork, int* info);
}

namespace ringdown::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Spectrum spectrum(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(symmetric);
  return {solved.eigenvalues(), solved.eigenvectors()};
}

Spectrum3 spectrum_of_3(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(symmetric);
  return {solved.eigenvalues(), solved.eigenvectors()};
}

VectorXd eigenvalues(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

// With mass = L L^T: the spectrum of L^-1 stiffness L^-T, its vectors times L^-T.
std::optional<Spectrum> generalized_spectrum(const MatrixXd& stiffness, const MatrixXd& mass) {
  MatrixXd lower = mass;
  if (!cholesky(lower)) return std::nullopt;
  MatrixXd whole = stiffness.selfadjointView<Eigen::Lower>();
  solve_lower(lower, whole);
  divide_by_upper(lower, whole);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(whole);
  if (solved.info() != Eigen::Success) return std::nullopt;
  MatrixXd vectors = solved.eigenvectors();
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(vectors);
  return Spectrum{solved.eigenvalues(), std::move(vectors)};
}

bool cholesky(MatrixXd& a) {
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factored(a);
  return factored.info() == Eigen::Success;
}

void solve_lower(const MatrixXd& lower, MatrixXd& b) { lower.triangularView<Eigen::Lower>().solveInPlace(b); }

void divide_by_upper(const MatrixXd& lower, MatrixXd& b) {
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(b);
}

MatrixXd solve_symmetric(const MatrixXd& a, const MatrixXd& b) { return Eigen::LDLT<MatrixXd>(a).solve(b); }

MatrixXd inverse(const MatrixXd& a) { return a.inverse(); }

MatrixXd orthonormal_basis(MatrixXd columns) {
  constexpr int kBlock = 64;  // columns at once; LAPACK is fastest with this number
  const auto m = static_cast<int>(columns.rows()), n = static_cast<int>(columns.cols());
  const int work_size = kBlock * n;
  std::vector<double> tau(static_cast<std::size_t>(n)), work(static_cast<std::size_t>(work_size));
  int info = 0;
  dgeqrf_(&m, &n, columns.data(), &m, tau.data(), work.data(), &work_size, &info);
  dorgqr_(&m, &n, &n, columns.data(), &m, tau.data(), work.data(), &work_size, &info);
  return columns;
}

}  // namespace ringdown::dense
