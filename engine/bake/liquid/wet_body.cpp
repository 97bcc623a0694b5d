#include "engine/bake/liquid/wet_body.h"

#include "engine/dense/decompositions.h"
#include "engine/liquid/potential.h"
#include "engine/liquid/water_modes.h"
#include "engine/liquid/wet_modes.h"
#include "engine/solve/slaved_response.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kPatterns = 12;          // pressures that the body is let give way to, for each liquid
constexpr double kShift = -1e-3;       // of the band's top, above which all lies that SlavedResponse lets give way
constexpr double kIndependent = 1e-6;  // of corrections of unit mass: less is a repetition of others
constexpr double kGutter = 0.05;       // of the largest basin's volume: so much smaller ones must be named to be filled

Vector3d to_eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

std::string place_text(const Vector3d& at) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g)", at[0], at[1], at[2]);
  return text;
}

// Finds the basins that a filling is for.
Result<std::vector<liquid::Basin>> chosen_basins(const Filling& filling, const liquid::WetWall& wall, double length_m) {
  const std::vector<liquid::Basin> basins = liquid::basins_of(wall);
  if (basins.empty()) {
    return fail(ErrorKind::bad_input,
                "it has no basin that holds a liquid: below every level it is open, so that it would leak; check `up`, "
                "or leave [fill] out");
  }
  const auto bottom_of = [&](const liquid::Basin& basin) -> Vector3d {
    return wall.skin().surface.nodes.row(basin.bottom).transpose() * length_m;
  };
  if (filling.basins_m.empty()) {
    if (basins.size() == 1 || basins[1].volume < kGutter * basins[0].volume) return std::vector{basins.front()};
    std::string places;
    for (std::size_t b = 0; b < std::min<std::size_t>(basins.size(), 4); ++b)
      places += (places.empty() ? "" : ", ") + place_text(bottom_of(basins[b]));
    return fail(ErrorKind::bad_input, "it has " + std::to_string(basins.size()) + " basins, with their bottoms at " +
                                          places + (basins.size() > 4 ? ", ..." : "") +
                                          " m; say which are filled by basin = [x, y, z]");
  }
  std::vector<liquid::Basin> chosen;
  for (const Vec3& place_m : filling.basins_m) {
    const Vector3d place = to_eigen(place_m);
    const auto nearest = std::ranges::min_element(
        basins, {}, [&](const liquid::Basin& basin) { return (bottom_of(basin) - place).norm(); });
    const double reach = 1.5 * std::cbrt(nearest->volume) * length_m;
    if ((bottom_of(*nearest) - place).norm() > reach) {
      return fail(ErrorKind::bad_input, "there is no basin at " + place_text(place) +
                                            " m; the nearest has its bottom at " + place_text(bottom_of(*nearest)) +
                                            " m");
    }
    const auto known = std::ranges::find(chosen, nearest->bottom, &liquid::Basin::bottom);
    if (known == chosen.end()) chosen.push_back(*nearest);
  }
  return chosen;
}

WetPart part_of(liquid::Wetted wetted, const liquid::Liquid& liquid, const WetUnits& units) {
  return {.wetted = std::move(wetted),
          .density = liquid.density_kg_m3 / units.density_kg_m3,
          .sound_speed = liquid.sound_speed_m_s / units.speed_m_s,
          .drag_si = std::sqrt(liquid.density_kg_m3 * liquid.viscosity_pa_s / 2)};
}

modal::LiquidNote note_of(const liquid::Liquid& liquid, double level_m, double volume_m3, const Vec3& up, bool bath) {
  return {.liquid = liquid.name,
          .density_kg_m3 = liquid.density_kg_m3,
          .sound_speed_m_s = liquid.sound_speed_m_s,
          .viscosity_pa_s = liquid.viscosity_pa_s,
          .level_m = level_m,
          .volume_m3 = volume_m3,
          .up = up,
          .around = bath};
}

Result<void> plan_bath(const Bath& bath, const WetUnits& units, WetPlan& plan) {
  const liquid::WetWall wall(plan.skin, to_eigen(bath.up));
  const double level = bath.level_m / units.length_m;
  std::vector<liquid::Piece> pieces = wall.pieces_below(level);
  std::erase_if(pieces, [](const liquid::Piece& piece) { return piece.is_basin(); });
  char text[96];
  std::snprintf(text, sizeof text, "it reaches from %.4g m to %.4g m", wall.lowest() * units.length_m,
                wall.highest() * units.length_m);
  if (pieces.empty())
    return fail(ErrorKind::bad_input, "the level of its bath lies below the body's lowest point: " + std::string(text));
  if (level >= wall.highest())
    return fail(ErrorKind::bad_input, "the bath covers all of it, and a body under a liquid is not modelled: " +
                                          std::string(text) + "; choose a lower level");
  double displaced = 0;
  for (const liquid::Piece& piece : pieces) displaced -= piece.volume;
  plan.parts.push_back(part_of(liquid::wetted_by(wall, pieces, level, true), bath.liquid, units));
  plan.notes.push_back(note_of(bath.liquid, bath.level_m, displaced * std::pow(units.length_m, 3), bath.up, true));
  return {};
}

// The rows of the skin's nodes, of shapes at the nodes of the system.
MatrixXd on_skin(const MatrixXd& shapes, const mesh::Boundary& surface, const std::vector<Index>& row_of) {
  MatrixXd found = MatrixXd::Zero(3 * static_cast<Index>(surface.nodes.size()), shapes.cols());
  for (std::size_t n = 0; n < surface.nodes.size(); ++n) {
    const Index row = row_of[surface.nodes[n]];
    if (row >= 0) found.middleRows<3>(3 * static_cast<Index>(n)) = shapes.middleRows<3>(row);
  }
  return found;
}

// The forces on the nodes of the system of pressures at a liquid's samples, N x m, along the normals out of it.
MatrixXd forces_of(const MatrixXd& pressures, const liquid::Wetted& wetted, const liquid::Skin& skin,
                   const mesh::Boundary& surface, const std::vector<Index>& row_of, Index rows) {
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
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

// One liquid's part in the eigenproblem.
struct PartTerms {
  liquid::WetPanels panels;
  std::optional<liquid::WaterModes> modes;  // of an enclosed liquid
  liquid::Potential potential;              // of the body's modes
  MatrixXd flow;                            // of them, samples x N
  MatrixXd bound;                           // N x all modes of the liquid: integrals of psi_j q_i
  Index first = 0, count = 0;               // of the liquid's modes that are oscillators
  Index row = 0;                            // of the first one in the eigenproblem
};

class WetSolver {
 public:
  WetSolver(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry, const fem::System& system,
            const std::vector<std::int32_t>& clamped, double top)
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

  Result<WetBody> run(const Progress& progress) {
    if (progress && !progress("liquid", 0)) return fail_cancelled();
    if (auto modes = find_liquid_modes(); !modes) return fail(modes);
    solve::SlavedResponse response(system_, dry_.shapes, kShift * top_);
    if (auto done = response.factor([&] { return !progress || progress("liquid", 0.1); }); !done) return fail(done);
    std::vector<MatrixXd> pressures;
    for (std::size_t p = 0; p < terms_.size(); ++p) pressures.push_back(first_pressures(p));
    correct(response(forces_of_all(pressures)));
    add_masses();
    Result<liquid::WetModes> wet = liquid::wet_modes_of(coupled_);
    if (!wet) return fail(wet);
    if (progress && !progress("liquid", 0.5)) return fail_cancelled();
    for (std::size_t p = 0; p < terms_.size(); ++p) pressures[p] = pressures_of(p, *wet);
    correct(response(forces_of_all(pressures)));
    add_masses();
    wet = liquid::wet_modes_of(coupled_);
    if (!wet) return fail(wet);
    if (progress && !progress("liquid", 0.8)) return fail_cancelled();
    if (auto estimated = estimate_errors(); !estimated) return fail(estimated);
    return finish(*wet);
  }

 private:
  Result<void> find_liquid_modes() {
    for (const WetPart& part : plan_.parts) {
      Result<liquid::WetPanels> panels = liquid::WetPanels::of(part.wetted);
      if (!panels) return fail(panels);
      PartTerms& terms = terms_.emplace_back(PartTerms{.panels = std::move(*panels)});
      if (!part.wetted.outside) terms.modes.emplace(part.wetted, terms.panels.panels());
    }
    return {};
  }

  [[nodiscard]] MatrixXd first_pressures(std::size_t part) const {
    const liquid::Wetted& wetted = plan_.parts[part].wetted;
    const auto& modes = terms_[part].modes;
    if (!modes) return plain_pressures(wetted.at);
    return modes->values(wetted.at).leftCols(std::min<Index>(kPatterns, modes->count()));
  }

  // Returns the pressures of the wet modes in the band, over omega squared and the density.
  [[nodiscard]] MatrixXd pressures_of(std::size_t part, const liquid::WetModes& wet) const {
    const Index count = (wet.lambda.array() <= top_).count() - dry_.rigid;
    const PartTerms& terms = terms_[part];
    MatrixXd pressures = terms.panels.values() * (terms.potential.nodes * wet.body.middleCols(dry_.rigid, count));
    if (terms.count > 0) {
      pressures += terms.modes->values(plan_.parts[part].wetted.at).middleCols(terms.first, terms.count) *
                   swing(plan_.parts[part], terms, wet.liquid.middleCols(dry_.rigid, count));
    }
    return pressures;
  }

  [[nodiscard]] MatrixXd forces_of_all(const std::vector<MatrixXd>& pressures) const {
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
  void correct(const MatrixXd& responses) {
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

  // Estimates the error of the added mass from its difference to that of a coarser wall. The error falls with the
  // square of the panels' size.
  Result<void> estimate_errors() {
    error_ = MatrixXd::Zero(basis_.cols(), basis_.cols());
    for (std::size_t p = 0; p < terms_.size(); ++p) {
      const WetPart& part = plan_.parts[p];
      const auto coarse = liquid::WetPanels::of(part.wetted, static_cast<int>(liquid::kWetNodes / kFewer));
      if (!coarse) return fail(coarse);
      error_ += part.density / (kFewer - 1) *
                (terms_[p].potential.added_mass - coarse->potential_of(terms_[p].flow).added_mass);
    }
    return {};
  }

  void add_masses() {
    const MatrixXd shapes = on_skin(basis_, surface_, row_of_);
    const Index n = basis_.cols();
    coupled_.stiffness = lambda_.asDiagonal();
    coupled_.mass = MatrixXd::Identity(n, n);
    Index oscillators = 0;
    for (std::size_t p = 0; p < terms_.size(); ++p) {
      const WetPart& part = plan_.parts[p];
      PartTerms& terms = terms_[p];
      terms.flow = liquid::flow_of(part.wetted, plan_.skin, shapes);
      terms.potential = terms.panels.potential_of(terms.flow);
      coupled_.mass += part.density * terms.potential.added_mass;
      if (!terms.modes) continue;
      terms.bound = terms.flow.transpose() * terms.modes->values(part.wetted.at);
      if (!part.wetted.open) {  // the constant mode of a full cavity is a spring
        coupled_.stiffness +=
            part.density * part.sound_speed * part.sound_speed * (terms.bound.col(0) * terms.bound.col(0).transpose());
        terms.first = 1;
      }
      const double highest = kLiquidBand * std::sqrt(top_) / part.sound_speed;
      terms.count = std::max<Index>((terms.modes->wavenumbers().array() <= highest).count() - terms.first, 0);
      terms.row = oscillators;
      oscillators += terms.count;
    }
    coupled_.own_lambda.resize(oscillators);
    coupled_.bond.resize(n, oscillators);
    for (std::size_t p = 0; p < terms_.size(); ++p) {
      const PartTerms& terms = terms_[p];
      if (terms.count == 0) continue;
      const WetPart& part = plan_.parts[p];
      const VectorXd kappa = terms.modes->wavenumbers().segment(terms.first, terms.count);
      coupled_.own_lambda.segment(terms.row, terms.count) = (part.sound_speed * kappa).array().square();
      coupled_.bond.middleCols(terms.row, terms.count) = std::sqrt(part.density) *
                                                         terms.bound.middleCols(terms.first, terms.count) *
                                                         kappa.cwiseInverse().asDiagonal();
    }
  }

  WetBody finish(const liquid::WetModes& wet) {
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
    effects.errors = 0.5 * (own.transpose() * error_ * own).diagonal().cwiseAbs();
    effects.drag = VectorXd::Zero(count);
    effects.air = plan_.air;
    effects.notes = plan_.notes;
    const MatrixXd on_wall = on_skin(modes.shapes.rightCols(count), surface_, row_of_);
    for (std::size_t p = 0; p < terms_.size(); ++p) {
      add_drag(plan_.parts[p], terms_[p], own, liquids, on_wall, effects.drag);
      add_free_flow(plan_.parts[p], terms_[p], plan_.air.free[p], own, liquids, effects);
    }
    return body;
  }

  // The amplitudes of the liquid's modes in the potential, beside the still one: y_j / (kappa_j sqrt(rho)).
  static MatrixXd swing(const WetPart& part, const PartTerms& terms, const MatrixXd& liquids) {
    const VectorXd kappa = terms.modes->wavenumbers().segment(terms.first, terms.count);
    return (std::sqrt(part.density) * kappa).cwiseInverse().asDiagonal() * liquids.middleRows(terms.row, terms.count);
  }

  // The boundary layer at the wall takes R_s/2 times the square of the slip between liquid and wall (Landau & Lifshitz,
  // Fluid Mechanics, section 24).
  void add_drag(const WetPart& part, const PartTerms& terms, const MatrixXd& own, const MatrixXd& liquids,
                const MatrixXd& on_wall, VectorXd& drag) const {
    using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
    const liquid::Wetted& wetted = part.wetted;
    const MatrixXd nodes = terms.potential.nodes * own;
    std::array<MatrixXd, 3> swings;
    if (terms.count > 0) {
      swings = terms.modes->slopes(wetted.at);
      const MatrixXd amplitudes = swing(part, terms, liquids);
      for (MatrixXd& slope : swings) slope = slope.middleCols(terms.first, terms.count) * amplitudes;
    }
    for (Index s = 0; s < wetted.at.rows(); ++s) {
      MatrixXd slip = terms.panels.slope_at(s, nodes);
      MatrixXd motion = MatrixXd::Zero(3, own.cols());
      for (Rows::InnerIterator node(plan_.skin.samples.interpolation, wetted.samples[s]); node; ++node)
        motion += node.value() * on_wall.middleRows<3>(3 * node.col());
      slip -= wetted.turn * motion;
      if (terms.count > 0) {
        for (int axis = 0; axis < 3; ++axis) slip.row(axis) += swings[axis].row(s);
      }
      const Vector3d normal = wetted.normals.row(s).transpose();
      slip -= normal * (normal.transpose() * slip);
      drag += 0.5 * part.drag_si * wetted.areas[s] * slip.colwise().squaredNorm().transpose();
    }
  }

  // The flow through the free surface, by the liquid's modes. What the wall lets out at rest must come in through the
  // surface; what the polynomials miss of that is spread over it.
  static void add_free_flow(const WetPart& part, const PartTerms& terms, const liquid::FreeSurface& free,
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
      flow -= free.areas.asDiagonal() * slope.middleCols(terms.first, terms.count) * swing(part, terms, liquids);
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

  const WetPlan& plan_;
  const mesh::Boundary& surface_;
  const solve::Eigenmodes& dry_;
  const fem::System& system_;
  const double top_;
  std::vector<Index> row_of_;  // of each node of the mesh, in the system; -1: clamped
  std::vector<PartTerms> terms_;
  MatrixXd corrections_;
  MatrixXd basis_;   // 3N x n: dry modes and corrections
  VectorXd lambda_;  // n
  liquid::Coupled coupled_;
  MatrixXd error_;  // n x n: of the added mass, as estimated
};

}  // namespace

Result<void> plan_filling(const Filling& filling, const WetUnits& units, WetPlan& plan) {
  const liquid::WetWall wall(plan.skin, to_eigen(filling.up));
  const double metre = 1 / units.length_m;
  liquid::Amount amount = filling.amount;
  amount.value *= amount.kind == liquid::Amount::Kind::kVolume ? metre * metre * metre : metre;
  const auto basins = chosen_basins(filling, wall, units.length_m);
  if (!basins) return fail(basins);
  for (const liquid::Basin& basin : *basins) {
    const Result<double> level = liquid::level_of(wall, basin, amount, metre);
    if (!level) return fail(level);
    const liquid::Piece piece = liquid::piece_of(wall, basin, *level);
    if (piece.triangles.empty())
      return fail(ErrorKind::bad_input, "the liquid spills into another basin below that level; fill that one");
    plan.parts.push_back(part_of(liquid::wetted_by(wall, {piece}, *level, false), filling.liquid, units));
    plan.notes.push_back(note_of(filling.liquid, *level * units.length_m, piece.volume * std::pow(units.length_m, 3),
                                 filling.up, false));
  }
  return {};
}

Result<WetPlan> plan_liquids(const Liquids& liquids, const mesh::TetMesh& unit_mesh, const mesh::Boundary& surface,
                             const WetUnits& units) {
  WetPlan plan{.skin = liquid::skin_of(unit_mesh, surface), .parts = {}, .air = {}, .notes = {}};
  if (liquids.fill) {
    if (auto planned = plan_filling(*liquids.fill, units, plan); !planned) return fail(planned);
  }
  if (liquids.bath) {
    if (auto planned = plan_bath(*liquids.bath, units, plan); !planned) return fail(planned);
  }
  std::vector<liquid::Wetted> wetted;
  for (const WetPart& part : plan.parts) wetted.push_back(part.wetted);
  Result<liquid::AirSurface> air = liquid::air_surface_of(plan.skin, wetted);
  if (!air) return fail(air);
  plan.air = std::move(*air);
  return plan;
}

Result<WetBody> wet_body(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                         const fem::System& system, const std::vector<std::int32_t>& clamped, double top,
                         const Progress& progress) {
  return WetSolver(plan, surface, dry, system, clamped, top).run(progress);
}

}  // namespace ringdown::bake
