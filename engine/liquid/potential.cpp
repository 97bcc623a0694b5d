#include "engine/liquid/potential.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/decompositions.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::liquid {
namespace {

// The wall and its image in the free surface.
mesh::TriangleMesh doubled(const mesh::TriangleMesh& wall) {
  const Eigen::Index nodes = wall.nodes.rows(), triangles = wall.triangles.rows();
  mesh::TriangleMesh both;
  std::vector<Eigen::Index> image(static_cast<std::size_t>(nodes));
  Eigen::Index count = nodes;
  for (Eigen::Index n = 0; n < nodes; ++n) image[n] = wall.nodes(n, 0) == 0 ? n : count++;
  both.nodes.resize(count, 3);
  both.nodes.topRows(nodes) = wall.nodes;
  for (Eigen::Index n = 0; n < nodes; ++n) {
    if (image[n] != n) both.nodes.row(image[n]) << -wall.nodes(n, 0), wall.nodes(n, 1), wall.nodes(n, 2);
  }
  both.triangles.resize(2 * triangles, 3);
  both.triangles.topRows(triangles) = wall.triangles;
  for (Eigen::Index t = 0; t < triangles; ++t) {
    for (int i = 0; i < 3; ++i)
      both.triangles(triangles + t, i) = static_cast<std::int32_t>(image[wall.triangles(t, 2 - i)]);
  }
  return both;
}

// Solves M x = b with the mass matrix of the hats, by conjugate gradients: its condition is small.
Eigen::MatrixXd divided_by_mass(const Eigen::SparseMatrix<double, Eigen::RowMajor>& mass, const Eigen::MatrixXd& b) {
  constexpr int kMaxSteps = 60;
  const Eigen::VectorXd inverse = Eigen::VectorXd(mass.diagonal()).cwiseInverse();
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(b.rows(), b.cols()), r = b, z = inverse.asDiagonal() * r, p = z;
  Eigen::RowVectorXd old = r.cwiseProduct(z).colwise().sum();
  const Eigen::RowVectorXd small = 1e-20 * old;
  for (int step = 0; step < kMaxSteps && (old.array() > small.array()).any(); ++step) {
    const Eigen::MatrixXd heavy = mass * p;
    const Eigen::RowVectorXd curved = p.cwiseProduct(heavy).colwise().sum();
    const Eigen::RowVectorXd length = (curved.array() > 0).select(old.array() / curved.array(), 0);
    x += p * length.asDiagonal();
    r -= heavy * length.asDiagonal();
    z = inverse.asDiagonal() * r;
    const Eigen::RowVectorXd next = r.cwiseProduct(z).colwise().sum();
    const Eigen::RowVectorXd ratio = (old.array() > 0).select(next.array() / old.array(), 0);
    p = z + p * ratio.asDiagonal();
    old = next;
  }
  return x;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> hat_mass(const radiate::Panels& panels) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int row : panels.corners[t]) {
      for (const int column : panels.corners[t])
        entries.emplace_back(row, column, panels.areas[t] / (row == column ? 6 : 12));
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> mass(panels.node_count(), panels.node_count());
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

// Finds the panel and the corners' weights of each sample.
void place_samples(const Wetted& liquid, Potential& potential) {
  const radiate::SurfaceSearch search(potential.panels);
  std::vector<Eigen::Triplet<double>> weights;
  for (Eigen::Index s = 0; s < liquid.at.rows(); ++s) {
    const Eigen::Vector3d outward = (liquid.outside ? -1 : 1) * liquid.normals.row(s).transpose();
    const radiate::NearestPoint place = search.nearest(liquid.at.row(s).transpose(), outward);
    potential.triangle_at.push_back(place.triangle);
    for (int i = 0; i < 3; ++i)
      weights.emplace_back(static_cast<int>(s), potential.panels.corners[place.triangle][i], place.weights[i]);
  }
  potential.values.resize(liquid.at.rows(), potential.panels.node_count());
  potential.values.setFromTriplets(weights.begin(), weights.end());
}

// The real and imaginary parts of the wave matrix at k = 0 and eta = 1 are -W and M/2 - K'. Images count negative.
struct Operators {
  Eigen::MatrixXf steep;  // W
  Eigen::MatrixXf side;   // M/2 - K'
};

//
// From a point of a flat face, the whole closed surface fills half of all directions. So the columns of M/2 - K', summed
// over the wall and its image, have the sums of M. Where triangles meet at an angle the integrals miss that by some
// percent of the angle; what they miss is added to the diagonal, as it lies close by. That turns an error of first order
// in the size of the triangles into one of second order.
Operators operators_of(const radiate::Skin& skin, const Eigen::VectorXd& weights, int threads) {
  const radiate::Panels& panels = skin.panels;
  const std::vector<double> coupling(static_cast<std::size_t>(panels.node_count()), 1.0);
  Operators operators;
  radiate::ComplexMatrix matrix;
  Eigen::VectorXf missed = weights.cast<float>();
  for (int image = 0; image < panels.image_count(); ++image) {
    radiate::wave_matrix(panels, image, skin.near[image], 0, coupling, matrix, threads);
    missed -= matrix.imag().colwise().sum().transpose();
    if (image == 0) {
      operators = {-matrix.real(), matrix.imag()};
    } else {
      operators.steep += matrix.real();
      operators.side -= matrix.imag();
    }
  }
  operators.side.diagonal() += missed;
  return operators;
}

}  // namespace

Eigen::MatrixXd Potential::slope_at(Eigen::Index sample) const {
  const int triangle = triangle_at[sample];
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(3, nodes.cols());
  for (int i = 0; i < 3; ++i) {
    slope += panels.curls[triangle][i].cross(panels.normals[triangle]) * nodes.row(panels.corners[triangle][i]);
  }
  return slope;
}

Result<Potential> potential_of(const Wetted& liquid, const Eigen::MatrixXd& flow, int nodes, int threads) {
  radiate::Body body;
  body.surface = liquid.open ? doubled(liquid.wall) : liquid.wall;
  body.flow.positions.resize(0, 3);
  body.flow.normals.resize(0, 3);
  body.flow.flow.resize(0, 0);
  const Result<radiate::Original> original = radiate::Original::of(body, liquid.open ? 1 : 0);
  if (!original) return fail(original.error());
  const double side = std::sqrt(liquid.wall_area() / (0.866 * nodes));
  Result<radiate::Skin> skin = radiate::skin_of(*original, side);
  if (!skin) return fail(skin.error());
  Potential potential;
  potential.panels = skin->panels;
  const radiate::Panels& panels = potential.panels;
  place_samples(liquid, potential);
  const auto mass = hat_mass(panels);
  const Eigen::VectorXd weights = mass * Eigen::VectorXd::Ones(mass.cols());
  Operators operators = operators_of(*skin, weights, thread_count(threads));
  Eigen::MatrixXd at_nodes = potential.values.transpose() * flow;
  if (!liquid.open) {
    at_nodes -= weights * (at_nodes.colwise().sum() / weights.sum());
  }
  const Eigen::MatrixXd density = divided_by_mass(mass, at_nodes);
  Eigen::MatrixXd right = (operators.side * density.cast<float>()).cast<double>();
  if (liquid.outside) right = mass * density - right;
  if (liquid.open) {  // the potential is 0 at nodes on the free surface
    for (int n = 0; n < panels.node_count(); ++n) {
      if (panels.planes_at(n) == 0) continue;
      operators.steep.row(n).setZero();
      operators.steep.col(n).setZero();
      operators.steep(n, n) = 1;
      right.row(n).setZero();
    }
  } else {  // constants cost nothing: this fixes the mean
    const Eigen::VectorXf weight = weights.cast<float>();
    operators.steep += weight * weight.transpose() / (weight.sum() * std::sqrt(weight.sum()));
  }
  const Eigen::LLT<Eigen::MatrixXf> factors(operators.steep);
  if (factors.info() != Eigen::Success)
    return fail(ErrorKind::bad_input, "the potential of the liquid cannot be found: its wall is too distorted");
  potential.nodes = factors.solve(right.cast<float>()).cast<double>();
  const Eigen::MatrixXd raw = at_nodes.transpose() * potential.nodes;
  potential.added_mass = (raw + raw.transpose()) / 2;
  potential.asymmetry = (raw - raw.transpose()).norm() / raw.norm();
  dense::Spectrum spectrum = dense::spectrum(potential.added_mass);
  if (spectrum.values.size() > 0 && spectrum.values[0] < 0) {
    spectrum.values = spectrum.values.cwiseMax(0.0);
    potential.added_mass = spectrum.vectors * spectrum.values.asDiagonal() * spectrum.vectors.transpose();
  }
  return potential;
}

}  // namespace ringdown::liquid
