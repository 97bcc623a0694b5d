// Decompositions of dense matrices as plain functions. [any thread]
//
// Eigen's decompositions are templates that take seconds to compile for each type of matrix. They are compiled once,
// in decompositions.cpp, and other files include no Eigen header of them.
//
// A symmetric matrix is read in its lower triangle, unless a function says otherwise. Nothing fails but cholesky() and
// generalized_spectrum(); results of matrices that hold NaN are NaN.
#pragma once

#include <Eigen/Core>

#include <optional>

namespace ringdown::dense {

// Eigenvalues ascending; eigenvectors are columns, orthonormal.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
struct Spectrum3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};

Spectrum spectrum(const Eigen::MatrixXd& symmetric);
Spectrum3 spectrum_of_3(const Eigen::Matrix3d& symmetric);
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

// stiffness x = lambda mass x, with x^T mass x = 1. Nothing when the mass is not positive.
std::optional<Spectrum> generalized_spectrum(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass);

// Puts L with L L^T = a into the lower triangle of a. False when a is not positive definite.
bool cholesky(Eigen::MatrixXd& a);
// b := L^-1 b, and b := b L^-T, with the lower triangle L.
void solve_lower(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b);
void divide_by_upper(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b);

// a^-1 b of a symmetric a that is positive or nearly so, by L D L^T.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// Any square matrix, by L U.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

// An orthonormal basis of the columns, of which there are no more than rows, by Householder's reflections.
Eigen::MatrixXd orthonormal_basis(Eigen::MatrixXd columns);

}  // namespace ringdown::dense
