// Products of dense matrices as plain functions. [any thread]
//
// Eigen compiles a product for each pair of types, in four variants, which takes a quarter of a second each time. For
// matrices and blocks of matrices, these functions need only one compiled instance of each kind.
#pragma once

#include <Eigen/Core>

namespace ringdown::dense {

using Operand = Eigen::Ref<const Eigen::MatrixXd>;

Eigen::MatrixXd product(const Operand& a, const Operand& b);             // a b
Eigen::MatrixXd transposed_product(const Operand& a, const Operand& b);  // a^T b
Eigen::MatrixXd product_transposed(const Operand& a, const Operand& b);  // a b^T

void set_product(Eigen::Ref<Eigen::MatrixXd> result, const Operand& a, const Operand& b);              // := a b
void add_product(Eigen::Ref<Eigen::MatrixXd> sum, double factor, const Operand& a, const Operand& b);  // += factor a b

}  // namespace ringdown::dense
