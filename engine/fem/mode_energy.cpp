#include "engine/fem/mode_energy.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/dense/products.h"
#include "engine/fem/element.h"

namespace ringdown::fem {

// Each thread sums a share of the elements; the shares are added in order, so the result is the same in every run with
// one number of processors.
ModeEnergy mode_energy(const mesh::TetMesh& mesh, const Solid& solid, const std::vector<std::int32_t>& part_of,
                       int parts, const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
  const int threads = thread_count(0);
  const dense::BlasThreads one(1);
  const Eigen::Index n = mesh.elements.cols(), modes = shapes.cols(), elements = mesh.elements.rows();
  const ModeEnergy none{Eigen::MatrixXd::Zero(parts, modes), Eigen::MatrixXd::Zero(parts, modes)};
  std::vector<ModeEnergy> sums(threads, none);
  in_parallel(threads, [&](int thread) {
    ElementIntegrals integrals(mesh.order());
    Eigen::MatrixXd stiffness(3 * n, 3 * n), mass(n, n), values(3 * n, modes), pushed(3 * n, modes);
    for (Eigen::Index e = elements * thread / threads; e < elements * (thread + 1) / threads; ++e) {
      integrals(nodes_of(mesh, e), solid.at(e), stiffness, mass);
      for (Eigen::Index a = 0; a < n; ++a)
        values.middleRows<3>(3 * a) = shapes.middleRows<3>(3 * Eigen::Index{mesh.elements(e, a)});
      const int part = part_of.empty() ? 0 : part_of[e];
      dense::set_product(pushed, stiffness, values);
      sums[thread].strain.row(part) += values.cwiseProduct(pushed).colwise().sum();
      for (int i = 0; i < 3; ++i) {
        const Eigen::MatrixXd along = values(Eigen::seqN(i, n, 3), Eigen::all);
        dense::set_product(pushed.topRows(n), mass, along);
        sums[thread].motion.row(part) += along.cwiseProduct(pushed.topRows(n)).colwise().sum();
      }
    }
  });
  ModeEnergy all = none;
  for (const ModeEnergy& share : sums) {
    all.strain += share.strain;
    all.motion += share.motion;
  }
  return all;
}

}  // namespace ringdown::fem
