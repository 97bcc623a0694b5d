// Decompositions of dense matrices as plain functions. [any thread]
//
// Eigen's decompositions are templates that take seconds to compile for each type of matrix. This project compiles them
// once, in decompositions.cpp, and other files need not include Eigen's headers for them.
//
// Functions read only the lower triangle of a symmetric matrix, unless they say otherwise. Only cholesky() and
// generalized_spectrum() can fail; results of matrices that hold NaN are NaN.
#pragma once

#include <Eigen/Core>

#include <optional>

namespace ringdown::dense {

// Eigenvalues ascending; eigenvectors are columns, orthonormal.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
struct HermitianSpectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXcd vectors;
};
struct Spectrum3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};

// Eigenvectors are columns of length 1.
struct ComplexSpectrum {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

Spectrum spectrum(const Eigen::MatrixXd& symmetric);
Spectrum3 spectrum_of_3(const Eigen::Matrix3d& symmetric);
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);
HermitianSpectrum hermitian_spectrum(Eigen::MatrixXcd matrix);
// Returns the eigenvalues and eigenvectors of any square matrix, in no order.
ComplexSpectrum complex_spectrum(Eigen::MatrixXcd matrix);

// Solves stiffness x = lambda mass x, with x^T mass x = 1. Empty when the mass is not positive definite.
std::optional<Spectrum> generalized_spectrum(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass);

// Puts L with L L^H = a into the lower triangle of a. Returns false when a is not positive definite.
bool cholesky(Eigen::MatrixXd& a);
bool cholesky(Eigen::MatrixXf& a);
bool cholesky(Eigen::MatrixXcd& a);
// b := (L L^H)^-1 b, with the lower triangle L.
void solve_cholesky(const Eigen::MatrixXf& lower, Eigen::MatrixXf& b);
void solve_cholesky(const Eigen::MatrixXcd& lower, Eigen::VectorXcd& b);
// b := L^-1 b, and b := b L^-T, with the lower triangle L.
void solve_lower(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b);
void solve_lower(const Eigen::MatrixXcd& lower, Eigen::MatrixXcd& b);
void divide_by_upper(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b);

// a^-1 b for a symmetric a that is positive definite or nearly so, by L D L^T.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The x that makes |a x - b| least and, where a has not full rank, x as well; a has no fewer rows than columns.
Eigen::MatrixXcd least_squares(Eigen::MatrixXcd a, Eigen::MatrixXcd b);

// The inverse of any square matrix, by L U.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

// An orthonormal basis of the span of the columns, by Householder's reflections. There must be no more columns than
// rows.
Eigen::MatrixXd orthonormal_basis(Eigen::MatrixXd columns);

}  // namespace ringdown::dense
