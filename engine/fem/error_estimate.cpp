#include "engine/fem/error_estimate.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/fem/surplus.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

// The estimate
//
// With V the functions of the mesh and W those of degree p + 1, a mode's residual r(w) = K(phi, w) - lambda M(phi, w)
// is zero on V. In V + W lambda falls by r A^-1 r, with A the energy of W after V has relaxed, a Schur complement.
// Computing A would need solves with all of V. Two energies that are cheaper to compute enclose A:
//
//   K_WW, no relaxation at all                        from above, so lambda's fall from below
//   K_WW - K_WV K_VV^+ K_VW of each element alone     from below, because an element alone relaxes more
//
// The estimate uses the mean of both energies, with weights 1 - kRelaxed and kRelaxed. In flat elements and for nearly
// incompressible materials the first gives a fall that is too small by large factors (functions of W alone lock), the
// second one that is too large; their mean stays within narrow bounds (docs/how/accuracy.md has the measurements that
// chose the weight). For the same reason these energies contain a softened Lame constant: mu^(1/4) lambda^(3/4) instead
// of lambda where lambda exceeds mu, with lambda limited to 60 mu. A body that keeps its volume in V + W moves like one
// with nu = 1/2. The residual contains the true constant.
//
// For each group of kModesAtOnce modes: residuals() finds r on all functions of W; falls() runs a few steps of
// conjugate gradients on A e = r, preconditioned by the blocks of A that belong to one edge, face or element; the
// energy of e after the last step is the fall of lambda.
namespace ringdown::fem {
namespace {

constexpr int kModesAtOnce = 32;
constexpr Eigen::Index kElementsAtOnce = 256;
constexpr int kSteps =
    6;  // steps of conjugate gradients; the fall is then 1 % too small in well-shaped elements, 10 to 40 % in flat ones

// A measured, not derived, factor for the functions of degrees above p + 1 and for the error of the mean above.
double surplus_factor(int order) { return (order + 1) / 3.0; }

using Rows = Eigen::Matrix<float, Eigen::Dynamic, kModesAtOnce, Eigen::RowMajor>;  // 3 count() unknowns, or 3w
using PerMode = Eigen::Array<double, 1, kModesAtOnce>;

class SurplusProblem {
 public:
  SurplusProblem(const mesh::TetMesh& mesh, const Solid& solid, const Holding& holding)
      : mesh_(mesh), solid_(solid), holding_(holding), space_(surplus_space(mesh)), element_(mesh.order()) {}

  // Residuals of all modes, kModesAtOnce per entry, the last entry padded with zeros. Also stores every element's
  // energy.
  std::vector<Rows> residuals(const Eigen::Ref<const Eigen::VectorXd>& lambda,
                              const Eigen::Ref<const Eigen::MatrixXd>& shapes, int threads);

  // A lower bound of r A^-1 r for each mode of a group.
  [[nodiscard]] PerMode falls(Rows r) const;

 private:
  void add_residual(const SurplusMatrices& matrices, Eigen::Index e, const Eigen::Ref<const Eigen::VectorXd>& lambda,
                    const Eigen::Ref<const Eigen::MatrixXd>& shapes, Rows& residual) const;
  void add_layers(const Eigen::Ref<const Eigen::VectorXd>& lambda, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                  std::vector<Rows>& residuals);
  void clamp(std::vector<Rows>& residuals);
  [[nodiscard]] int opposite_of(const mesh::OuterFace& face) const;
  void invert_parts();
  [[nodiscard]] Rows energy_times(const Rows& x) const;
  [[nodiscard]] Rows preconditioned(const Rows& x) const;

  const mesh::TetMesh& mesh_;
  const Solid& solid_;
  const Holding& holding_;
  SurplusSpace space_;
  SurplusElement element_;
  std::vector<Eigen::MatrixXf> energies_;  // energies, one per element
  std::vector<Eigen::MatrixXf> inverses_;  // inverse energies of each edge's, face's and element's own functions
};

void SurplusProblem::add_residual(const SurplusMatrices& matrices, Eigen::Index e,
                                  const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                  const Eigen::Ref<const Eigen::MatrixXd>& shapes, Rows& residual) const {
  const int w = element_.functions(), n = element_.nodes();
  Eigen::MatrixXd values(3 * n, shapes.cols());
  for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
    for (int a = 0; a < n; ++a) {
      for (int i = 0; i < 3; ++i) values(i * n + a, m) = shapes(3 * space_.nodes(e, a) + i, m);
    }
  }
  Eigen::MatrixXd local = dense::product(matrices.coupling, values);
  values *= lambda.asDiagonal();
  for (int i = 0; i < 3; ++i)
    dense::add_product(local.middleRows(i * w, w), -1, matrices.mass, values.middleRows(i * n, n));
  Rows rows = Rows::Zero(3 * w, kModesAtOnce);
  rows.leftCols(shapes.cols()) = local.cast<float>();
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < w; ++a) residual.row(3 * space_.functions(e, a) + i) += rows.row(i * w + a);
  }
}

std::vector<Rows> SurplusProblem::residuals(const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                            const Eigen::Ref<const Eigen::MatrixXd>& shapes, int threads) {
  std::vector<Rows> groups((shapes.cols() + kModesAtOnce - 1) / kModesAtOnce,
                           Rows::Zero(3 * space_.count(), kModesAtOnce));
  energies_.resize(mesh_.elements.rows());
  for (Eigen::Index first = 0; first < mesh_.elements.rows(); first += kElementsAtOnce) {
    std::vector<SurplusMatrices> batch(std::min(kElementsAtOnce, mesh_.elements.rows() - first));
    in_parallel(threads, [&](int thread) {
      for (std::size_t k = thread; k < batch.size(); k += threads) {
        const auto e = first + static_cast<Eigen::Index>(k);
        batch[k] = element_(mesh_.nodes(space_.nodes.row(e), Eigen::all), solid_.at(e));
        energies_[e] = batch[k].energy;
      }
    });
    in_parallel(threads, [&](int thread) {
      for (std::size_t g = thread; g < groups.size(); g += threads) {
        const auto begin = kModesAtOnce * static_cast<Eigen::Index>(g);
        const auto modes = std::min<Eigen::Index>(kModesAtOnce, shapes.cols() - begin);
        for (std::size_t k = 0; k < batch.size(); ++k) {
          add_residual(batch[k], first + static_cast<Eigen::Index>(k), lambda.segment(begin, modes),
                       shapes.middleCols(begin, modes), groups[g]);
        }
      }
    });
  }
  if (!holding_.layers.empty()) add_layers(lambda, shapes, groups);
  if (!holding_.clamped.empty()) clamp(groups);
  invert_parts();
  return groups;
}

// The corner opposite to a face, in the order of SurplusSpace::nodes.
int SurplusProblem::opposite_of(const mesh::OuterFace& face) const {
  int corner = 0;
  while (std::find(face.corners.begin(), face.corners.end(), space_.nodes(face.element, corner)) != face.corners.end())
    ++corner;
  return corner;
}

// Adds springs and glued masses to the residual, and springs to the energy of W.
void SurplusProblem::add_layers(const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                const Eigen::Ref<const Eigen::MatrixXd>& shapes, std::vector<Rows>& residuals) {
  const int w = element_.functions(), n = element_.nodes(), order = mesh_.order();
  for (const Layer& layer : holding_.layers) {
    for (const mesh::OuterFace& face : layer.faces) {
      const Eigen::Index e = face.element;
      for (const FacePoint& point : points_on_face(mesh_.nodes(space_.nodes.row(e), Eigen::all), opposite_of(face))) {
        const Eigen::VectorXd finer = surplus_shape(order, point.barycentric),
                              values = mesh::interpolation(order, point.barycentric);
        const Eigen::Matrix3d springs = point.area * stiffness_at(layer, point);
        Eigen::MatrixXd at = Eigen::MatrixXd::Zero(3, shapes.cols());
        for (int a = 0; a < n; ++a) {
          if (values[a] != 0) at += values[a] * shapes.middleRows<3>(3 * Eigen::Index{space_.nodes(e, a)});
        }
        const Eigen::MatrixXd pull = springs * at - layer.mass_kg_m2 * point.area * at * lambda.asDiagonal();
        for (int a = 0; a < w; ++a) {
          if (finer[a] == 0) continue;
          for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
            residuals[m / kModesAtOnce].block<3, 1>(3 * space_.functions(e, a), m % kModesAtOnce) +=
                (finer[a] * pull.col(m)).cast<float>();
          }
          for (int b = 0; b < w; ++b) {
            for (int j = 0; j < 3; ++j) {
              for (int i = 0; i < 3; ++i)
                energies_[e](i * w + a, j * w + b) += static_cast<float>(finer[a] * finer[b] * springs(i, j));
            }
          }
        }
      }
    }
  }
}

// Keeps the functions of clamped edges and faces at zero: removes their residual and decouples their energy.
void SurplusProblem::clamp(std::vector<Rows>& residuals) {
  const int w = element_.functions(), per_face = surplus_per_face(mesh_.order());
  std::vector<char> clamped(space_.count(), 0);
  for (const mesh::OuterFace& face : holding_.clamped) {
    const int opposite = opposite_of(face);
    for (std::size_t k = 0; k < kRisingEdges.size(); ++k) {
      const auto& [a, b] = kRisingEdges[k];
      if (a != opposite && b != opposite) clamped[space_.functions(face.element, static_cast<Eigen::Index>(k))] = 1;
    }
    for (std::size_t k = 0; k < kRisingFaces.size(); ++k) {
      if (std::ranges::find(kRisingFaces[k], opposite) != kRisingFaces[k].end()) continue;
      for (int j = 0; j < per_face; ++j)
        clamped[space_.functions(face.element, static_cast<Eigen::Index>(kRisingEdges.size() + per_face * k + j))] = 1;
    }
  }
  for (Rows& rows : residuals) {
    for (int function = 0; function < space_.count(); ++function) {
      if (clamped[function]) rows.middleRows<3>(3 * function).setZero();
    }
  }
  for (Eigen::Index e = 0; e < space_.functions.rows(); ++e) {
    for (int a = 0; a < w; ++a) {
      if (!clamped[space_.functions(e, a)]) continue;
      for (int i = 0; i < 3; ++i) {
        const float own = energies_[e](i * w + a, i * w + a);
        energies_[e].row(i * w + a).setZero();
        energies_[e].col(i * w + a).setZero();
        energies_[e](i * w + a, i * w + a) = own;
      }
    }
  }
}

void SurplusProblem::invert_parts() {
  std::vector<int> part_of(space_.count());
  std::vector<Eigen::MatrixXd> energies;
  for (std::size_t part = 0; part + 1 < space_.parts.size(); ++part) {
    const int first = space_.parts[part], functions = space_.parts[part + 1] - first;
    for (int k = 0; k < functions; ++k) part_of[first + k] = static_cast<int>(part);
    energies.push_back(Eigen::MatrixXd::Zero(3 * functions, 3 * functions));
  }
  const int w = element_.functions();
  for (Eigen::Index e = 0; e < space_.functions.rows(); ++e) {
    for (int b = 0; b < w; ++b) {
      for (int a = 0; a < w; ++a) {
        const int row = space_.functions(e, a), column = space_.functions(e, b), part = part_of[row];
        if (part != part_of[column]) continue;
        auto block = energies[part].block<3, 3>(3 * (row - space_.parts[part]), 3 * (column - space_.parts[part]));
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i) block(i, j) += energies_[e](i * w + a, j * w + b);
        }
      }
    }
  }
  for (const Eigen::MatrixXd& energy : energies) inverses_.push_back(dense::inverse(energy).cast<float>());
}

Rows SurplusProblem::energy_times(const Rows& x) const {
  const int w = element_.functions();
  Rows y = Rows::Zero(x.rows(), kModesAtOnce), values(3 * w, kModesAtOnce), local(3 * w, kModesAtOnce);
  for (Eigen::Index e = 0; e < space_.functions.rows(); ++e) {
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < w; ++a) values.row(i * w + a) = x.row(3 * space_.functions(e, a) + i);
    }
    local.noalias() = energies_[e] * values;
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < w; ++a) y.row(3 * space_.functions(e, a) + i) += local.row(i * w + a);
    }
  }
  return y;
}

Rows SurplusProblem::preconditioned(const Rows& x) const {
  Rows y(x.rows(), kModesAtOnce);
  for (std::size_t part = 0; part < inverses_.size(); ++part) {
    const Eigen::Index first = 3 * space_.parts[part], rows = inverses_[part].rows();
    for (Eigen::Index i = 0; i < rows; ++i) {
      y.row(first + i) = inverses_[part](i, 0) * x.row(first);
      for (Eigen::Index j = 1; j < rows; ++j) y.row(first + i) += inverses_[part](i, j) * x.row(first + j);
    }
  }
  return y;
}

PerMode products(const Rows& a, const Rows& b) {
  PerMode sum = PerMode::Zero();
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    sum += a.row(row).array().cast<double>() * b.row(row).array().cast<double>();
  }
  return sum;
}

// Returns a / b, or 0 where b is not positive.
PerMode ratios(const PerMode& a, const PerMode& b) { return (b > 0).select(a / b, 0.0); }

// x += factor y, mode by mode.
void add(Rows& x, const PerMode& factor, const Rows& y) {
  const Eigen::Array<float, 1, kModesAtOnce> scale = factor.cast<float>();
  for (Eigen::Index row = 0; row < x.rows(); ++row) x.row(row).array() += scale * y.row(row).array();
}

// Conjugate gradients on A e = r from e = 0, for all modes of the group at once. After each step the energy of e is the
// sum of (step length)(r z), and grows towards r A^-1 r (Hestenes & Stiefel, J. Res. NBS 49, 1952, theorem 6:1).
PerMode SurplusProblem::falls(Rows r) const {
  Rows z = preconditioned(r), p = z;
  PerMode rz = products(r, z), fall = PerMode::Zero();
  for (int step = 1;; ++step) {
    const Rows energy_p = energy_times(p);
    const PerMode length = ratios(rz, products(p, energy_p));
    fall += length * rz;
    if (step == kSteps) return fall;
    add(r, -length, energy_p);
    z = preconditioned(r);
    const PerMode before = std::exchange(rz, products(r, z));
    add(z, ratios(rz, before), p);
    p.swap(z);
  }
}

}  // namespace

Result<Eigen::VectorXd> frequency_errors(const mesh::TetMesh& mesh, const Solid& solid,
                                         const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                         const Eigen::Ref<const Eigen::MatrixXd>& shapes, int threads,
                                         const Holding& holding) {
  threads = thread_count(threads);
  const dense::BlasThreads one(1);
  try {
    SurplusProblem problem(mesh, solid, holding);
    std::vector<Rows> residuals = problem.residuals(lambda, shapes, threads);
    Eigen::VectorXd falls(lambda.size());
    in_parallel(threads, [&](int thread) {
      for (std::size_t g = thread; g < residuals.size(); g += threads) {
        const auto begin = kModesAtOnce * static_cast<Eigen::Index>(g);
        const auto modes = std::min<Eigen::Index>(kModesAtOnce, lambda.size() - begin);
        falls.segment(begin, modes) = problem.falls(std::move(residuals[g])).head(modes).transpose();
      }
    });
    // Half of lambda's relative fall, to first order. The root keeps large errors, as of bending in linear elements, in
    // proportion.
    const Eigen::ArrayXd ratio = surplus_factor(mesh.order()) * falls.array() / lambda.array();
    const Eigen::ArrayXd errors = (1 + ratio).sqrt() - 1;
    return errors.unaryExpr([](double error) { return error < kMaxFrequencyError ? error : kMaxFrequencyError; })
        .matrix();
  } catch (const std::exception&) {
    return fail(ErrorKind::no_memory, "not enough memory to estimate the errors of {} modes; make the mesh coarser",
                lambda.size());
  }
}

}  // namespace ringdown::fem
