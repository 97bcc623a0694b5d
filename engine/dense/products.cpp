#include "engine/dense/products.h"

namespace ringdown::dense {

using Eigen::MatrixXd;

MatrixXd product(const Operand& a, const Operand& b) { return a * b; }
MatrixXd transposed_product(const Operand& a, const Operand& b) { return a.transpose() * b; }
MatrixXd product_transposed(const Operand& a, const Operand& b) { return a * b.transpose(); }

void set_product(Eigen::Ref<MatrixXd> result, const Operand& a, const Operand& b) { result.noalias() = a * b; }
void add_product(Eigen::Ref<MatrixXd> sum, double factor, const Operand& a, const Operand& b) {
  sum.noalias() += factor * a * b;
}

}  // namespace ringdown::dense
