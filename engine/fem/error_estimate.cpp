#include "engine/fem/error_estimate.h"

#include "engine/mesh/surplus_basis.h"
#include "engine/mesh/tet_shape.h"

#include <Eigen/LU>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <thread>
#include <vector>

namespace ringdown::fem {
namespace {

using mesh::Indices;
using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr Eigen::Index kModesAtOnce = 32;
constexpr Eigen::Index kElementsAtOnce = 256;

void in_parallel(int threads, Eigen::Index count, const std::function<void(Eigen::Index)>& work) {
  std::atomic<Eigen::Index> next = 0;
  const auto run = [&] {
    for (Eigen::Index i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < std::min<Eigen::Index>(threads, count); ++t) others.emplace_back(run);
  run();
}

// ---- space

using Order4 = std::array<int, 4>;

std::vector<int> permuted_nodes(int order, const Order4& corner) {
  const mesh::Lattice points = mesh::lattice(order);
  std::vector<int> from(points.rows());
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    Eigen::RowVector4d old;
    for (int s = 0; s < 4; ++s) old[corner[s]] = points(a, s);
    for (Eigen::Index b = 0; b < points.rows(); ++b) {
      if ((points.row(b) - old).norm() < 1e-9) from[a] = static_cast<int>(b);
    }
  }
  return from;
}

Indices with_rising_corners(const Indices& elements, int order) {
  std::map<Order4, std::vector<int>> permutations;
  Indices sorted(elements.rows(), elements.cols());
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    Order4 corner = {0, 1, 2, 3};
    std::sort(corner.begin(), corner.end(), [&](int a, int b) { return elements(e, a) < elements(e, b); });
    auto [from, is_new] = permutations.try_emplace(corner);
    if (is_new) from->second = permuted_nodes(order, corner);
    for (Eigen::Index a = 0; a < elements.cols(); ++a) sorted(e, a) = elements(e, from->second[a]);
  }
  return sorted;
}

template <std::size_t kCorners, std::size_t kCount>
Indices number_parts(const Indices& elements, const std::array<std::array<int, kCorners>, kCount>& parts, int& count) {
  using Part = std::array<std::int32_t, kCorners>;
  std::vector<Part> all;
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    for (const auto& part : parts) {
      Part nodes;
      for (std::size_t i = 0; i < kCorners; ++i) nodes[i] = elements(e, part[i]);
      all.push_back(nodes);
    }
  }
  std::vector<Part> unique = all;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  count = static_cast<int>(unique.size());
  Indices numbers(elements.rows(), kCount);
  for (std::size_t i = 0; i < all.size(); ++i) {
    numbers.data()[i] =
        static_cast<std::int32_t>(std::lower_bound(unique.begin(), unique.end(), all[i]) - unique.begin());
  }
  return numbers;
}

struct Space {
  int order;
  Indices nodes;      // E x n
  Indices functions;  // E x w
  int edges = 0, faces = 0, count = 0;
};

Space make_space(const mesh::TetMesh& mesh) {
  Space space;
  space.order = mesh::order_of_nodes(mesh.elements.cols());
  space.nodes = with_rising_corners(mesh.elements, space.order);
  const Eigen::Index elements = space.nodes.rows();
  const Indices edges = number_parts(space.nodes, mesh::kRisingEdges, space.edges);
  const Indices faces = number_parts(space.nodes, mesh::kRisingFaces, space.faces);
  const int per_face = mesh::surplus_per_face(space.order), inside = mesh::surplus_inside(space.order);
  space.functions.resize(elements, mesh::surplus_per_element(space.order));
  for (Eigen::Index e = 0; e < elements; ++e) {
    int a = 0;
    for (int k = 0; k < 6; ++k) space.functions(e, a++) = edges(e, k);
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < per_face; ++i) space.functions(e, a++) = space.edges + per_face * faces(e, k) + i;
    }
    for (int i = 0; i < inside; ++i) {
      space.functions(e, a++) = space.edges + per_face * space.faces + inside * static_cast<int>(e) + i;
    }
  }
  space.count = space.edges + per_face * space.faces + inside * static_cast<int>(elements);
  return space;
}

// ---- element

struct Tables {
  int w, n;
  std::vector<double> weights;
  std::vector<mesh::ReferenceGradient> gradients;  // w surplus, n Lagrange
  Eigen::MatrixXd surplus, shapes;                 // w x Q, n x Q
  mesh::Lattice lattice;
  Eigen::MatrixXd grams;  // 3w x 3(w+n)
  Eigen::MatrixXd mass;   // w x n

  explicit Tables(int order) : w(mesh::surplus_per_element(order)), n(mesh::nodes_per_element(order)) {
    const auto rule = mesh::tet_quadrature(2 * order + 1);
    surplus.resize(w, rule.size());
    shapes.resize(n, rule.size());
    for (std::size_t q = 0; q < rule.size(); ++q) {
      weights.push_back(rule[q].weight / 6);
      gradients.emplace_back(w + n, 3);
      gradients.back() << mesh::surplus_gradient(order, rule[q].barycentric),
          mesh::reference_gradient(order, rule[q].barycentric);
      surplus.col(q) = mesh::surplus_shape(order, rule[q].barycentric);
      shapes.col(q) = mesh::shape(order, rule[q].barycentric);
    }
    lattice = mesh::lattice(order);
    const Eigen::Map<const Eigen::VectorXd> weight(weights.data(), weights.size());
    mass = surplus * weight.asDiagonal() * shapes.transpose();
    grams = Eigen::MatrixXd::Zero(3 * w, 3 * (w + n));
    for (std::size_t q = 0; q < weights.size(); ++q) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          grams.block(k * w, l * (w + n), w, w + n) +=
              weights[q] * gradients[q].col(k).head(w) * gradients[q].col(l).transpose();
        }
      }
    }
  }
};

struct Element {
  Eigen::MatrixXd coupling;  // 3w x 3n
  Eigen::MatrixXd mass;      // w x n
  Eigen::MatrixXf own;       // 3w x 3w
};

Eigen::MatrixXd grams_of(const Tables& t, const Eigen::Matrix<double, Eigen::Dynamic, 3>& nodes, Eigen::MatrixXd& mass) {
  const Eigen::Matrix<double, 4, 3> corners = nodes.topRows<4>();
  const int w = t.w, all = t.w + t.n;
  const double size = (corners.row(1) - corners.row(0)).norm();
  if ((nodes - t.lattice * corners).cwiseAbs().maxCoeff() < 1e-9 * size) {
    const Eigen::Matrix3d jacobian = corners.bottomRows<3>().rowwise() - corners.row(0);
    const double det = std::abs(jacobian.determinant());
    const Eigen::Matrix3d inverse = jacobian.inverse();
    mass = det * t.mass;
    Eigen::MatrixXd half = Eigen::MatrixXd::Zero(3 * w, 3 * all), grams = half;
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) half.middleRows(k * w, w) += det * inverse(k, m) * t.grams.middleRows(m * w, w);
    }
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) grams.middleCols(k * all, all) += inverse(k, m) * half.middleCols(m * all, all);
    }
    return grams;
  }
  const auto points = static_cast<Eigen::Index>(t.weights.size());
  Eigen::MatrixXd gradients(3 * all, points);
  Eigen::VectorXd volumes(points);
  for (Eigen::Index q = 0; q < points; ++q) {
    const Eigen::Matrix3d jacobian = t.gradients[q].bottomRows(t.n).transpose() * nodes;
    volumes[q] = t.weights[q] * std::abs(jacobian.determinant());
    Eigen::Map<Eigen::MatrixXd>(gradients.col(q).data(), all, 3) = t.gradients[q] * jacobian.inverse().transpose();
  }
  mass = t.surplus * volumes.asDiagonal() * t.shapes.transpose();
  Eigen::MatrixXd left(3 * w, points);
  for (int k = 0; k < 3; ++k) left.middleRows(k * w, w) = gradients.middleRows(k * all, w) * volumes.asDiagonal();
  return left * gradients.transpose();
}

Element element_matrices(const Tables& t, const Eigen::Matrix<double, Eigen::Dynamic, 3>& nodes, const Elastic& elastic) {
  Element element;
  const Eigen::MatrixXd grams = grams_of(t, nodes, element.mass);
  const int w = t.w, n = t.n, all = w + n;
  const double lambda = elastic.lambda_pa(), mu = elastic.mu_pa();
  const auto gram = [&](int k, int l) { return grams.block(k * w, l * all, w, all); };
  const Eigen::MatrixXd trace = mu * (gram(0, 0) + gram(1, 1) + gram(2, 2));
  element.mass *= elastic.density_kg_m3;
  element.coupling.resize(3 * w, 3 * n);
  element.own.resize(3 * w, 3 * w);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Eigen::MatrixXd block = lambda * gram(i, j) + mu * gram(j, i);
      if (i == j) block += trace;
      element.own.block(i * w, j * w, w, w) = block.leftCols(w).cast<float>();
      element.coupling.block(i * w, j * n, w, n) = block.rightCols(n);
    }
  }
  return element;
}

// ---- residual & CG

struct Problem {
  Space space;
  Tables tables;
  std::vector<Eigen::MatrixXf> own;
  Rows residual;  // 3 count x modes
};

void add_residual(const Problem& problem, const Element& element, Eigen::Index e,
                  const Eigen::Ref<const Eigen::VectorXd>& lambda, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                  Eigen::Ref<Rows> residual) {
  const int w = problem.tables.w, n = problem.tables.n;
  Eigen::MatrixXd values(3 * n, shapes.cols());
  for (Eigen::Index m = 0; m < shapes.cols(); ++m) {
    for (int a = 0; a < n; ++a) {
      const double* at = shapes.col(m).data() + 3 * problem.space.nodes(e, a);
      for (int i = 0; i < 3; ++i) values(i * n + a, m) = at[i];
    }
  }
  Eigen::MatrixXd local = element.coupling * values;
  values *= lambda.asDiagonal();
  for (int i = 0; i < 3; ++i) local.middleRows(i * w, w).noalias() -= element.mass * values.middleRows(i * n, n);
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < w; ++a) residual.row(3 * problem.space.functions(e, a) + i) += local.row(i * w + a).cast<float>();
  }
}

Rows times(const Problem& problem, const Rows& x) {
  const int w = problem.tables.w;
  Rows y = Rows::Zero(x.rows(), x.cols());
  Rows values(3 * w, x.cols()), local(3 * w, x.cols());
  for (Eigen::Index e = 0; e < problem.space.functions.rows(); ++e) {
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < w; ++a) values.row(i * w + a) = x.row(3 * problem.space.functions(e, a) + i);
    }
    local.noalias() = problem.own[e] * values;
    for (int i = 0; i < 3; ++i) {
      for (int a = 0; a < w; ++a) y.row(3 * problem.space.functions(e, a) + i) += local.row(i * w + a);
    }
  }
  return y;
}

// dense blocks of consecutive rows
struct Preconditioner {
  std::vector<int> first;  // rows
  std::vector<Eigen::MatrixXf> inverse;
};

Preconditioner make_preconditioner(const Problem& problem, int kind) {
  const Space& s = problem.space;
  const int per_face = mesh::surplus_per_face(s.order), inside = mesh::surplus_inside(s.order), w = problem.tables.w;
  Preconditioner p;
  std::vector<int> block_of(s.count), offset(s.count);
  std::vector<int> sizes;
  const auto add = [&](int f, int size) {
    p.first.push_back(3 * f);
    for (int i = 0; i < size; ++i) {
      block_of[f + i] = static_cast<int>(sizes.size());
      offset[f + i] = 3 * i;
    }
    sizes.push_back(3 * size);
  };
  if (kind < 2) {
    for (int f = 0; f < s.count; ++f) add(f, 1);
  } else {
    for (int f = 0; f < s.edges; ++f) add(f, 1);
    for (int f = 0; f < s.faces; ++f)
      if (per_face) add(s.edges + f * per_face, per_face);
    for (int e = 0; e < s.nodes.rows(); ++e)
      if (inside) add(s.edges + s.faces * per_face + e * inside, inside);
  }
  std::vector<Eigen::MatrixXd> blocks;
  for (int size : sizes) blocks.push_back(Eigen::MatrixXd::Zero(size, size));
  for (Eigen::Index e = 0; e < s.nodes.rows(); ++e) {
    for (int a = 0; a < w; ++a) {
      for (int b = 0; b < w; ++b) {
        const int fa = s.functions(e, a), fb = s.functions(e, b);
        if (block_of[fa] != block_of[fb]) continue;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            if (kind > 0 || (i == j))
            blocks[block_of[fa]](offset[fa] + i, offset[fb] + j) += problem.own[e](i * w + a, j * w + b);
      }
    }
  }
  for (const auto& block : blocks) p.inverse.push_back(block.inverse().cast<float>());
  return p;
}

Rows apply(const Preconditioner& p, const Rows& r) {
  Rows z(r.rows(), r.cols());
  for (std::size_t b = 0; b < p.first.size(); ++b) {
    z.middleRows(p.first[b], p.inverse[b].rows()).noalias() =
        p.inverse[b].lazyProduct(r.middleRows(p.first[b], p.inverse[b].rows()));
  }
  return z;
}

Eigen::RowVectorXd dots(const Rows& a, const Rows& b) {
  return (a.cast<double>().array() * b.cast<double>().array()).colwise().sum();
}

Eigen::VectorXd drops(const Problem& problem, const Preconditioner& pre, Rows r, int steps) {
  Rows z = apply(pre, r), p = z;
  Eigen::RowVectorXd rz = dots(r, z), drop = Eigen::RowVectorXd::Zero(r.cols());
  for (int k = 0; k < steps; ++k) {
    const Rows ap = times(problem, p);
    const Eigen::RowVectorXd pap = dots(p, ap);
    const Eigen::RowVectorXd alpha = (pap.array() > 0).select(rz.array() / pap.array(), 0.0);
    drop.array() += alpha.array() * rz.array();
    if (k + 1 == steps) break;
    r.array() -= ap.array().rowwise() * alpha.cast<float>().array();
    z = apply(pre, r);
    const Eigen::RowVectorXd next = dots(r, z);
    const Eigen::RowVectorXd beta = (rz.array() > 0).select(next.array() / rz.array(), 0.0);
    p = z.array() + p.array().rowwise() * beta.cast<float>().array();
    rz = next;
  }
  return drop.transpose();
}

}  // namespace

Eigen::VectorXd surplus_drop(const mesh::TetMesh& mesh, const Elastic& elastic,
                             const Eigen::Ref<const Eigen::VectorXd>& lambda,
                             const Eigen::Ref<const Eigen::MatrixXd>& shapes, const EstimateOptions& options) {
  Problem problem{make_space(mesh), Tables(mesh::order_of_nodes(mesh.elements.cols())), {}, {}};
  const Eigen::Index elements = mesh.elements.rows(), modes = shapes.cols();
  const Eigen::Index chunks = (modes + kModesAtOnce - 1) / kModesAtOnce;
  problem.own.resize(elements);
  std::vector<Rows> residuals;
  for (Eigen::Index c = 0; c < chunks; ++c) {
    residuals.push_back(Rows::Zero(3 * problem.space.count, std::min(kModesAtOnce, modes - c * kModesAtOnce)));
  }
  for (Eigen::Index first = 0; first < elements; first += kElementsAtOnce) {
    const Eigen::Index count = std::min(kElementsAtOnce, elements - first);
    std::vector<Element> batch(count);
    in_parallel(options.threads, count, [&](Eigen::Index k) {
      const Eigen::Matrix<double, Eigen::Dynamic, 3> nodes = mesh.nodes(problem.space.nodes.row(first + k), Eigen::all);
      batch[k] = element_matrices(problem.tables, nodes, elastic);
      problem.own[first + k] = batch[k].own;
    });
    in_parallel(options.threads, chunks, [&](Eigen::Index c) {
      const Eigen::Index from = c * kModesAtOnce, many = residuals[c].cols();
      for (Eigen::Index k = 0; k < count; ++k) {
        add_residual(problem, batch[k], first + k, lambda.segment(from, many), shapes.middleCols(from, many),
                     residuals[c]);
      }
    });
  }
  const Preconditioner pre = make_preconditioner(problem, options.blocks);
  Eigen::VectorXd drop(modes);
  in_parallel(options.threads, chunks, [&](Eigen::Index c) {
    const Eigen::Index many = residuals[c].cols();
    drop.segment(c * kModesAtOnce, many) = drops(problem, pre, std::move(residuals[c]), options.steps);
  });
  return drop.cwiseQuotient(lambda);
}

}  // namespace ringdown::fem
