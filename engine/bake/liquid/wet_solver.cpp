#include "engine/bake/liquid/wet_solver.h"

#include "engine/dense/decompositions.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr int kPatterns = 12;          // pressures that the body is let give way to, for each liquid
constexpr double kIndependent = 1e-6;  // of corrections of unit mass: less is a repetition of others

// The forces on the nodes of the system of pressures at a liquid's samples, N x m, along the normals out of it.
MatrixXd forces_of(const MatrixXd& pressures, const liquid::Wetted& wetted, const liquid::Skin& skin,
                   const mesh::Boundary& surface, const std::vector<Index>& row_of, Index rows) {
  MatrixXd forces = MatrixXd::Zero(rows, pressures.cols());
  const mesh::Points normals = wetted.normals * wetted.turn;
  for (Index s = 0; s < pressures.rows(); ++s) {
    for (Rows::InnerIterator node(skin.samples.interpolation, wetted.samples[s]); node; ++node) {
      const Index row = row_of[surface.nodes[node.col()]];
      if (row < 0) continue;
      forces.middleRows<3>(row) += (node.value() * wetted.areas[s]) * normals.row(s).transpose() * pressures.row(s);
    }
  }
  return forces;
}

// Smooth pressures that vanish at the level: what a liquid without modes of its own is let press with.
MatrixXd plain_pressures(const mesh::Points& at) {
  MatrixXd pressures(at.rows(), 6);
  const Eigen::ArrayXd x = at.col(0), y = at.col(1).array() - at.col(1).mean(),
                       z = at.col(2).array() - at.col(2).mean();
  pressures << x, x * y, x * z, x * y * z, x * (y.square() - z.square()), x * (y.square() + z.square());
  return pressures;
}

}  // namespace

Result<PartTerms> PartTerms::of(const WetPart& part) {
  Result<liquid::WetPanels> panels = liquid::WetPanels::of(part.wetted, part.wall_nodes);
  if (!panels) return fail(panels);
  PartTerms terms{.panels = std::move(*panels)};
  if (!part.wetted.outside) terms.modes.emplace(part.wetted, terms.panels.panels());
  return terms;
}

void PartTerms::add_shapes(const WetPart& part, const liquid::Skin& skin, const MatrixXd& shapes, double top) {
  flow = liquid::flow_of(part.wetted, skin, shapes);
  potential = panels.potential_of(flow);
  if (!modes) return;
  bound = flow.transpose() * modes->values(part.wetted.at);
  first = part.wetted.open ? 0 : 1;
  const double highest = kLiquidBand * std::sqrt(top) / part.sound_speed;
  count = std::max<Index>((modes->wavenumbers().array() <= highest).count() - first, 0);
}

MatrixXd PartTerms::bond(const WetPart& part) const {
  if (count == 0) return {flow.cols(), 0};
  return std::sqrt(part.density) * bound.middleCols(first, count) * wavenumbers().cwiseInverse().asDiagonal();
}

VectorXd PartTerms::wavenumbers() const {
  return count == 0 ? VectorXd() : VectorXd(modes->wavenumbers().segment(first, count));
}

MatrixXd PartTerms::swing(const WetPart& part, const MatrixXd& liquids) const {
  return (std::sqrt(part.density) * wavenumbers()).cwiseInverse().asDiagonal() * liquids;
}

VectorXd PartTerms::drag(const WetPart& part, const liquid::Skin& skin, const MatrixXd& own, const MatrixXd& liquids,
                         const MatrixXd& on_wall) const {
  const liquid::Wetted& wetted = part.wetted;
  const MatrixXd nodes = potential.nodes * own;
  VectorXd drag = VectorXd::Zero(own.cols());
  std::array<MatrixXd, 3> swings;
  if (count > 0) {
    swings = modes->slopes(wetted.at);
    const MatrixXd amplitudes = swing(part, liquids);
    for (MatrixXd& slope : swings) slope = slope.middleCols(first, count) * amplitudes;
  }
  for (Index s = 0; s < wetted.at.rows(); ++s) {
    MatrixXd slip = panels.slope_at(s, nodes);
    MatrixXd motion = MatrixXd::Zero(3, own.cols());
    for (Rows::InnerIterator node(skin.samples.interpolation, wetted.samples[s]); node; ++node)
      motion += node.value() * on_wall.middleRows<3>(3 * node.col());
    slip -= wetted.turn * motion;
    if (count > 0) {
      for (int axis = 0; axis < 3; ++axis) slip.row(axis) += swings[axis].row(s);
    }
    const Vector3d normal = wetted.normals.row(s).transpose();
    slip -= normal * (normal.transpose() * slip);
    drag += 0.5 * part.drag_si * wetted.areas[s] * slip.colwise().squaredNorm().transpose();
  }
  return drag;
}

WetSolver::WetSolver(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                     const fem::System& system, const std::vector<std::int32_t>& clamped, double top)
    : plan_(plan), surface_(surface), dry_(dry), system_(system), top_(top) {
  const Index removed = static_cast<Index>(clamped.size()), nodes = system.unknowns() / 3 + removed;
  std::size_t next = 0;
  Index row = 0;
  for (Index n = 0; n < nodes; ++n) {
    const bool gone = next < clamped.size() && clamped[next] == n;
    row_of_.push_back(gone ? -1 : 3 * row);
    gone ? ++next : ++row;
  }
}

Result<void> WetSolver::solve(const solve::SlavedResponse& response, const Progress& progress) {
  for (const WetPart& part : plan_.parts) {
    Result<PartTerms> terms = PartTerms::of(part);
    if (!terms) return fail(terms);
    terms_.push_back(std::move(*terms));
  }
  std::vector<MatrixXd> pressures;
  for (std::size_t p = 0; p < terms_.size(); ++p) pressures.push_back(first_pressures(p));
  correct(response(forces_of_all(pressures)));
  if (auto coupled = couple(); !coupled) return coupled;
  if (progress && !progress("liquid", 0.5)) return fail_cancelled();
  for (std::size_t p = 0; p < terms_.size(); ++p) pressures[p] = pressures_of(p);
  correct(response(forces_of_all(pressures)));
  if (auto coupled = couple(); !coupled) return coupled;
  if (progress && !progress("liquid", 0.8)) return fail_cancelled();
  return {};
}

Result<WetBody> WetSolver::body() const {
  const Result<MatrixXd> errors = mass_errors();
  if (!errors) return fail(errors);
  return finish(*errors);
}

MatrixXd WetSolver::lowest(Index count) const {
  return basis_ * wet_.body.middleCols(dry_.rigid, std::min(count, wet_.lambda.size() - dry_.rigid));
}

MatrixXd WetSolver::on_skin(const MatrixXd& shapes) const {
  MatrixXd found = MatrixXd::Zero(3 * static_cast<Index>(surface_.nodes.size()), shapes.cols());
  for (std::size_t n = 0; n < surface_.nodes.size(); ++n) {
    const Index row = row_of_[surface_.nodes[n]];
    if (row >= 0) found.middleRows<3>(3 * static_cast<Index>(n)) = shapes.middleRows<3>(row);
  }
  return found;
}

MatrixXd WetSolver::first_pressures(std::size_t part) const {
  const liquid::Wetted& wetted = plan_.parts[part].wetted;
  const auto& modes = terms_[part].modes;
  if (!modes) return plain_pressures(wetted.at);
  return modes->values(wetted.at).leftCols(std::min<Index>(kPatterns, modes->count()));
}

// Returns the pressures of the wet modes in the band, over omega squared and the density.
MatrixXd WetSolver::pressures_of(std::size_t part) const {
  const Index count = (wet_.lambda.array() <= top_).count() - dry_.rigid;
  const PartTerms& terms = terms_[part];
  MatrixXd pressures = terms.panels.values() * (terms.potential.nodes * wet_.body.middleCols(dry_.rigid, count));
  if (terms.count > 0) {
    pressures += terms.modes->values(plan_.parts[part].wetted.at).middleCols(terms.first, terms.count) *
                 terms.swing(plan_.parts[part], wet_.liquid.block(terms.row, dry_.rigid, terms.count, count));
  }
  return pressures;
}

MatrixXd WetSolver::forces_of_all(const std::vector<MatrixXd>& pressures) const {
  MatrixXd forces(system_.unknowns(), 0);
  for (std::size_t p = 0; p < terms_.size(); ++p) {
    const Index before = forces.cols();
    forces.conservativeResize(Eigen::NoChange, before + pressures[p].cols());
    forces.rightCols(pressures[p].cols()) =
        forces_of(pressures[p], plan_.parts[p].wetted, plan_.skin, surface_, row_of_, system_.unknowns());
  }
  return forces;
}

// Adds static corrections to the dry modes: how the body gives way to pressures of the liquid beside its own modes.
// They are made diagonal in stiffness and mass, so that they are like further dry modes.
void WetSolver::correct(const MatrixXd& responses) {
  const Index before = corrections_.cols();
  corrections_.conservativeResize(system_.unknowns(), before + responses.cols());
  corrections_.rightCols(responses.cols()) = responses;
  const auto scale = [&](Index c) { return 1 / std::max(corrections_.col(c).norm(), 1e-300); };
  for (Index c = before; c < corrections_.cols(); ++c) corrections_.col(c) *= scale(c);
  const MatrixXd heavy = fem::mass_times(system_.node_mass, corrections_);
  MatrixXd mass = corrections_.transpose() * heavy;
  const VectorXd sizes = mass.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  mass = sizes.asDiagonal() * mass * sizes.asDiagonal();
  const dense::Spectrum independent = dense::spectrum((mass + mass.transpose()) / 2);
  const Index kept = (independent.values.array() > kIndependent).count();
  const MatrixXd more = corrections_ * (sizes.asDiagonal() * independent.vectors.rightCols(kept) *
                                        independent.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal());
  const MatrixXd steep = system_.stiffness.selfadjointView<Eigen::Lower>() * more;
  const dense::Spectrum own = dense::spectrum(more.transpose() * steep);
  const Index dry = dry_.lambda.size();
  basis_.resize(system_.unknowns(), dry + kept);
  basis_ << dry_.shapes, more * own.vectors;
  lambda_.resize(dry + kept);
  lambda_ << VectorXd::Zero(dry_.rigid), dry_.lambda.tail(dry - dry_.rigid), own.values;
}

// Finds the wet modes in the present basis.
Result<void> WetSolver::couple() {
  const MatrixXd shapes = on_skin(basis_);
  const Index n = basis_.cols();
  coupled_.stiffness = lambda_.asDiagonal();
  coupled_.mass = MatrixXd::Identity(n, n);
  Index oscillators = 0;
  for (std::size_t p = 0; p < terms_.size(); ++p) {
    const WetPart& part = plan_.parts[p];
    PartTerms& terms = terms_[p];
    terms.add_shapes(part, plan_.skin, shapes, top_);
    coupled_.mass += part.density * terms.potential.added_mass;
    if (terms.first == 1) {  // the constant mode of a full cavity is a spring
      coupled_.stiffness +=
          part.density * part.sound_speed * part.sound_speed * (terms.bound.col(0) * terms.bound.col(0).transpose());
    }
    terms.row = oscillators;
    oscillators += terms.count;
  }
  coupled_.own_lambda.resize(oscillators);
  coupled_.bond.resize(n, oscillators);
  for (std::size_t p = 0; p < terms_.size(); ++p) {
    const PartTerms& terms = terms_[p];
    if (terms.count == 0) continue;
    coupled_.own_lambda.segment(terms.row, terms.count) =
        (plan_.parts[p].sound_speed * terms.wavenumbers()).array().square();
    coupled_.bond.middleCols(terms.row, terms.count) = terms.bond(plan_.parts[p]);
  }
  Result<liquid::WetModes> wet = liquid::wet_modes_of(coupled_);
  if (!wet) return fail(wet);
  wet_ = std::move(*wet);
  return {};
}

// Estimates the error of the added mass from its difference to that of a coarser wall. The error falls with the
// square of the panels' size.
Result<MatrixXd> WetSolver::mass_errors() const {
  MatrixXd errors = MatrixXd::Zero(basis_.cols(), basis_.cols());
  for (std::size_t p = 0; p < terms_.size(); ++p) {
    const WetPart& part = plan_.parts[p];
    const auto coarse = liquid::WetPanels::of(part.wetted, static_cast<int>(part.wall_nodes / kFewer));
    if (!coarse) return fail(coarse);
    errors += part.density / (kFewer - 1) *
              (terms_[p].potential.added_mass - coarse->potential_of(terms_[p].flow).added_mass);
  }
  return errors;
}

WetBody WetSolver::finish(const MatrixXd& mass_errors) const {
  const liquid::WetModes& wet = wet_;
  const Index rigid = dry_.rigid, count = (wet.lambda.array() <= top_).count() - rigid;
  const VectorXd lambda = wet.lambda.segment(rigid, count);
  const MatrixXd own = wet.body.middleCols(rigid, count), liquids = wet.liquid.middleCols(rigid, count);
  WetBody body{.modes = dry_, .mixing = own.topRows(dry_.lambda.size()), .effects = {}};
  solve::Eigenmodes& modes = body.modes;
  modes.lambda.resize(rigid + count);
  modes.lambda << dry_.lambda.head(rigid), lambda;
  modes.shapes.resize(basis_.rows(), rigid + count);
  modes.shapes << dry_.shapes.leftCols(rigid), basis_ * own;
  modes.residuals = VectorXd::Zero(rigid + count);
  modes.residuals.tail(count).setConstant(dry_.residuals.size() > 0 ? dry_.residuals.maxCoeff() : 0);
  WetEffects& effects = body.effects;
  effects.strain = (lambda_.transpose() * own.cwiseAbs2()).transpose().cwiseQuotient(lambda);
  effects.motion = own.colwise().squaredNorm().transpose();
  effects.errors = 0.5 * (own.transpose() * mass_errors * own).diagonal().cwiseAbs();
  effects.drag = VectorXd::Zero(count);
  effects.air = plan_.air;
  effects.notes = plan_.notes;
  const MatrixXd on_wall = on_skin(modes.shapes.rightCols(count));
  for (std::size_t p = 0; p < terms_.size(); ++p) {
    const PartTerms& terms = terms_[p];
    const MatrixXd swinging = liquids.middleRows(terms.row, terms.count);
    effects.drag += terms.drag(plan_.parts[p], plan_.skin, own, swinging, on_wall);
    add_free_flow(plan_.parts[p], terms, plan_.air.free[p], own, swinging, effects);
  }
  return body;
}

// The flow through the free surface, by the liquid's modes. What the wall lets out at rest must come in through the
// surface; what the polynomials miss of that is spread over it.
void WetSolver::add_free_flow(const WetPart& part, const PartTerms& terms, const liquid::FreeSurface& free,
                              const MatrixXd& own, const MatrixXd& liquids, WetEffects& effects) {
  const Index samples = free.areas.size(), before = effects.free_areas.size();
  if (samples == 0) return;
  const MatrixXd slope = terms.modes->slopes(free.at)[0];
  const VectorXd kappa = terms.modes->wavenumbers();
  MatrixXd flow = -(free.areas.asDiagonal() * slope *
                    (kappa.cwiseAbs2().cwiseInverse().asDiagonal() * (terms.bound.transpose() * own)));
  const Eigen::RowVectorXd missing = -(terms.flow.colwise().sum() * own) - flow.colwise().sum();
  flow += free.areas / free.areas.sum() * missing;
  if (terms.count > 0)
    flow -= free.areas.asDiagonal() * slope.middleCols(terms.first, terms.count) * terms.swing(part, liquids);
  const liquid::Wetted& wetted = part.wetted;
  const auto grow = [&](auto& matrix, Index columns) { matrix.conservativeResize(before + samples, columns); };
  grow(effects.free_flow, own.cols());
  grow(effects.free_at, 3);
  grow(effects.free_normals, 3);
  effects.free_areas.conservativeResize(before + samples);
  effects.free_flow.bottomRows(samples) = flow;
  effects.free_at.bottomRows(samples) = (free.at.rowwise() - wetted.shift.transpose()) * wetted.turn;
  effects.free_normals.bottomRows(samples).rowwise() = -wetted.turn.row(0);
  effects.free_areas.tail(samples) = free.areas;
}

Result<WetBody> wet_body(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                         const fem::System& system, const std::vector<std::int32_t>& clamped, double top,
                         const Progress& progress) {
  if (progress && !progress("liquid", 0)) return fail_cancelled();
  solve::SlavedResponse response(system, dry.shapes, kResponseShift * top);
  if (auto done = response.factor([&] { return !progress || progress("liquid", 0.1); }); !done) return fail(done);
  WetSolver solver(plan, surface, dry, system, clamped, top);
  if (auto solved = solver.solve(response, progress); !solved) return fail(solved);
  return solver.body();
}

}  // namespace ringdown::bake
