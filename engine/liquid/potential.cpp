#include "engine/liquid/potential.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/decompositions.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_matrix.h"

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

}  // namespace

struct WetPanels::Parts {
  bool open = true, outside = false;
  radiate::Panels panels;                               // V nodes
  Eigen::SparseMatrix<double, Eigen::RowMajor> values;  // N x V: from nodes to the liquid's samples
  std::vector<int> triangle_at;                         // N: the panel of each sample
  Eigen::SparseMatrix<double, Eigen::RowMajor> mass;    // V x V, of the hats
  Eigen::VectorXd weights;                              // V: its row sums
  // A full closed cavity has the flow of the motion x/3, over the volume, and |x|^2/6; x is from the middle of the
  // nodes.
  Eigen::VectorXd swelling, quadratic;  // V
  double volume = 0;
  Eigen::MatrixXf side;   // M/2 - K'
  Eigen::MatrixXf steep;  // in its lower triangle the Cholesky factor of W

  // Finds the panel and the corners' weights of each sample.
  void place_samples(const Wetted& liquid);
  void find_swelling(const Wetted& liquid);
};

void WetPanels::Parts::find_swelling(const Wetted& liquid) {
  const Eigen::RowVector3d middle = panels.nodes.colwise().mean();
  const Eigen::VectorXd along =
      (liquid.at.rowwise() - middle).cwiseProduct(liquid.normals).rowwise().sum().cwiseProduct(liquid.areas) / 3;
  volume = along.sum();
  swelling = values.transpose() * along / volume;
  quadratic = (panels.nodes.rowwise() - middle).rowwise().squaredNorm() / 6;
}

void WetPanels::Parts::place_samples(const Wetted& liquid) {
  const radiate::SurfaceSearch search(panels);
  std::vector<Eigen::Triplet<double>> shares;
  for (Eigen::Index s = 0; s < liquid.at.rows(); ++s) {
    const Eigen::Vector3d outward = (liquid.outside ? -1 : 1) * liquid.normals.row(s).transpose();
    const radiate::NearestPoint place = search.nearest(liquid.at.row(s).transpose(), outward);
    triangle_at.push_back(place.triangle);
    for (int i = 0; i < 3; ++i)
      shares.emplace_back(static_cast<int>(s), panels.corners[place.triangle][i], place.weights[i]);
  }
  values.resize(liquid.at.rows(), panels.node_count());
  values.setFromTriplets(shares.begin(), shares.end());
}

namespace {

// The real and imaginary parts of the wave matrix at k = 0 and eta = 1 are -W and M/2 - K'. Images count negative.
struct Operators {
  Eigen::MatrixXf steep;  // W
  Eigen::MatrixXf side;   // M/2 - K'
};

//
// Seen from a point of a flat face, the whole closed surface fills half of all directions. Therefore the columns of M/2
// - K', summed over the wall and its image, have the sums of M. Where triangles meet at an angle the integrals miss
// that by some percent of the angle; what they miss is added to the diagonal, as it lies close by. That turns an error
// of first order in the size of the triangles into one of second order.
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

const radiate::Panels& WetPanels::panels() const { return parts_->panels; }

const Eigen::SparseMatrix<double, Eigen::RowMajor>& WetPanels::values() const { return parts_->values; }

Eigen::MatrixXd WetPanels::slope_at(Eigen::Index sample, const Eigen::MatrixXd& nodes) const {
  const radiate::Panels& panels = parts_->panels;
  const int triangle = parts_->triangle_at[sample];
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(3, nodes.cols());
  for (int i = 0; i < 3; ++i)
    slope += panels.curls[triangle][i].cross(panels.normals[triangle]) * nodes.row(panels.corners[triangle][i]);
  return slope;
}

Result<WetPanels> WetPanels::of(const Wetted& liquid, int nodes, int threads) {
  radiate::Body body;
  body.surface = liquid.open ? doubled(liquid.wall) : liquid.wall;
  body.flow.positions.resize(0, 3);
  body.flow.normals.resize(0, 3);
  body.flow.flow.resize(0, 0);
  const Result<radiate::Original> original = radiate::Original::of(body, liquid.open ? 1 : 0);
  if (!original) return fail(original);
  const double side = std::sqrt(liquid.wall_area() / (0.866 * nodes));
  const Result<radiate::Skin> skin = radiate::skin_of(*original, side);
  if (!skin) return fail(skin);
  const auto made = std::make_shared<Parts>();
  Parts& parts = *made;
  parts.open = liquid.open;
  parts.outside = liquid.outside;
  parts.panels = skin->panels;
  parts.place_samples(liquid);
  parts.mass = hat_mass(parts.panels);
  parts.weights = parts.mass * Eigen::VectorXd::Ones(parts.mass.cols());
  if (!liquid.open && !liquid.outside) parts.find_swelling(liquid);
  Operators operators = operators_of(*skin, parts.weights, thread_count(threads));
  if (liquid.open) {  // the potential is 0 at nodes on the free surface
    for (int n = 0; n < parts.panels.node_count(); ++n) {
      if (parts.panels.planes_at(n) == 0) continue;
      operators.steep.row(n).setZero();
      operators.steep.col(n).setZero();
      operators.steep(n, n) = 1;
    }
  } else {  // constants cost nothing: this fixes the mean
    const Eigen::VectorXf weight = parts.weights.cast<float>();
    operators.steep += weight * weight.transpose() / (weight.sum() * std::sqrt(weight.sum()));
  }
  parts.side = std::move(operators.side);
  parts.steep = std::move(operators.steep);
  if (!dense::cholesky(parts.steep))
    return fail(ErrorKind::bad_input, "the potential of the liquid cannot be found: its wall is too distorted");
  return WetPanels(made);
}

Potential WetPanels::potential_of(const Eigen::MatrixXd& flow) const {
  const Parts& parts = *parts_;
  const Eigen::MatrixXd given = parts.values.transpose() * flow;
  const bool swells = !parts.open && !parts.outside;
  const Eigen::RowVectorXd total = given.colwise().sum();
  Eigen::MatrixXd at_nodes = given;
  if (swells) at_nodes -= parts.swelling * total;
  const Eigen::MatrixXd density = divided_by_mass(parts.mass, at_nodes);
  Eigen::MatrixXd right = (parts.side * density.cast<float>()).cast<double>();
  if (parts.outside) right = at_nodes - right;
  if (parts.open) {
    for (int n = 0; n < parts.panels.node_count(); ++n) {
      if (parts.panels.planes_at(n) != 0) right.row(n).setZero();
    }
  }
  Potential potential;
  Eigen::MatrixXf nodes = right.cast<float>();
  dense::solve_cholesky(parts.steep, nodes);
  potential.nodes = nodes.cast<double>();
  if (swells) {  // the integrals over the volume are those of Green's formula with |x|^2/6, whose Laplacian is 1
    const Eigen::RowVectorXd of_still =
        parts.volume * (parts.swelling.transpose() * potential.nodes) - parts.quadratic.transpose() * at_nodes;
    const double of_square = 0.6 * parts.volume * parts.swelling.dot(parts.quadratic);
    potential.nodes += parts.quadratic * (total / parts.volume);
    potential.nodes.rowwise() -= (of_still + total / parts.volume * of_square) / parts.volume;
  }
  const Eigen::MatrixXd raw = given.transpose() * potential.nodes;
  potential.added_mass = (raw + raw.transpose()) / 2;
  if (raw.size() == 0) return potential;
  potential.asymmetry = (raw - raw.transpose()).norm() / raw.norm();
  const dense::Spectrum spectrum = dense::spectrum(potential.added_mass);
  if (spectrum.values[0] < 0) {
    potential.added_mass = spectrum.vectors * spectrum.values.cwiseMax(0.0).asDiagonal() * spectrum.vectors.transpose();
  }
  return potential;
}

}  // namespace ringdown::liquid
