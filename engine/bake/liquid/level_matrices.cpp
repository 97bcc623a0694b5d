#include "engine/bake/liquid/level_matrices.h"

#include "engine/dense/decompositions.h"
#include "engine/modal/levels/mode_followers.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kLooks = 5;           // levels whose wet modes go into the basis
constexpr double kMissing = 2e-5;   // share of a mode's strain energy that one further motion must have to be kept
constexpr double kShaped = 1e-3;    // such a share from which its shape is kept, too: without the rest, 3 % of a motion
constexpr double kGivesWay = 3e-5;  // relative change of lambda by a motion of the liquid, to be kept
constexpr Index kMaxMotions = 12;   // of the liquid; below modal::kMaxLiquidMotions

// Rigid motions of unit mass at the skin's nodes, 3S x 6, as a bank's reader makes them: along the axes, and about the
// principal ones.
MatrixXd rigid_motions(const modal::MassProperties& mass, const mesh::Points& nodes) {
  const auto& [x, y, z, w] = mass.orientation;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  const Vector3d center(mass.center_of_mass_m.x, mass.center_of_mass_m.y, mass.center_of_mass_m.z);
  const std::array inertia = {mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
  MatrixXd motions(3 * nodes.rows(), 6);
  for (Index p = 0; p < nodes.rows(); ++p) {
    const Vector3d arm = nodes.row(p).transpose() - center;
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(3 * p, axis) = Vector3d::Unit(axis) / std::sqrt(mass.mass_kg);
      motions.block<3, 1>(3 * p, 3 + axis) = turn.col(axis).cross(arm) / std::sqrt(inertia[axis]);
    }
  }
  return motions;
}

// Columns `shapes` without what the columns `known` have, in the mass of the body.
void remove(const MatrixXd& known, const fem::SparseMatrix& node_mass, MatrixXd& shapes) {
  const MatrixXd heavy = fem::mass_times(node_mass, known);
  const MatrixXd gram = known.transpose() * heavy;
  for (int turn = 0; turn < 2; ++turn) shapes -= known * dense::solve_symmetric(gram, heavy.transpose() * shapes);
}

// The matrices of one level.
struct AtLevel {
  PartTerms terms;
  Index in_reach = 0;    // number of the liquid's modes that a bake of this level alone would keep
  MatrixXd added, bond;  // N x N; N x J: S
  VectorXd own_lambda;   // J
};

class LevelFinder {
 public:
  LevelFinder(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
              const fem::System& system, const std::vector<std::int32_t>& clamped, double top, const WetBody& wet,
              const Progress& progress)
      : plan_(plan),
        surface_(surface),
        dry_(dry),
        system_(system),
        clamped_(clamped),
        top_(top),
        rigid_(dry.rigid),
        modes_(wet.modes.lambda.size() - dry.rigid),
        own_(wet.modes.shapes.rightCols(modes_)),
        body_shares_(wet.effects.strain.begin(), wet.effects.strain.end()),
        progress_(progress),
        solver_(plan, surface, dry, system, clamped, top) {}

  Result<WetLevels> run(const modal::MassProperties& mass) {
    if (rigid_ != 0 && rigid_ != 6)
      return fail(ErrorKind::bad_input,
                  "levels are found for a body that is free or held, and its supports let it move in {} ways",
                  static_cast<int>(rigid_));
    if (!go_on(0)) return fail_cancelled();
    if (auto looked = find_further(); !looked) return fail(looked);
    set_basis(mass);
    for (std::size_t l = 1; l < plan_.levels.size(); ++l) {
      if (!go_on(0.5 + 0.5 * static_cast<double>(l) / static_cast<double>(plan_.levels.size())))
        return fail_cancelled();
      Result<AtLevel> level = at_level(plan_.levels[l].part);
      if (!level) return fail(level);
      if (auto dragged = add_drag(l, *level); !dragged) return fail(dragged);
      own_modes_ = std::max(own_modes_, level->in_reach);
      levels_.added.push_back(std::move(level->added));
      giving_.push_back(Giving{std::move(level->bond), std::move(level->own_lambda)});
    }
    follow();
    return std::move(levels_);
  }

 private:
  [[nodiscard]] bool go_on(double done) const { return !progress_ || progress_("levels", done); }

  // Collects the wet modes of some levels, and those of the empty body, as far as they reach the band.
  Result<void> find_further() {
    solve::SlavedResponse response(system_, dry_.shapes, kResponseShift * top_);
    if (auto done = response.factor([&] { return go_on(0.02); }); !done) return done;
    const Index wanted = modes_ + modes_ / 6 + 4;
    std::vector<MatrixXd> looks = {
        dry_.shapes.middleCols(rigid_, std::min<Index>(wanted, dry_.lambda.size() - rigid_))};
    const std::size_t last = plan_.levels.size() - 1;
    std::size_t before = 0;
    for (int look = 1; look <= kLooks; ++look) {
      const std::size_t l = std::max<std::size_t>(1, last * static_cast<std::size_t>(look) / kLooks);
      if (l == std::exchange(before, l)) continue;
      WetPlan other{.skin = plan_.skin, .parts = {plan_.levels[l].part}, .levels = {}, .air = {}, .notes = {}};
      WetSolver solver(other, surface_, dry_, system_, clamped_, top_);
      if (auto solved = solver.solve(response, {}); !solved) return solved;
      looks.push_back(solver.lowest(wanted));
      if (!go_on(0.5 * look / kLooks)) return fail_cancelled();
    }
    Index columns = 0;
    for (const MatrixXd& look : looks) columns += look.cols();
    MatrixXd all(system_.unknowns(), columns);
    columns = 0;
    for (const MatrixXd& look : looks) {
      all.middleCols(columns, look.cols()) = look;
      columns += look.cols();
    }
    // Each counts by the part of its strain energy that the modes as baked do not have.
    const auto steep = [&](const MatrixXd& shapes) -> MatrixXd {
      return system_.stiffness.selfadjointView<Eigen::Lower>() * shapes;
    };
    for (Index c = 0; c < columns; ++c) all.col(c) /= std::sqrt(all.col(c).dot(steep(all.col(c)).col(0)));
    MatrixXd known(system_.unknowns(), rigid_ + modes_);
    known << dry_.shapes.leftCols(rigid_), own_;
    remove(known, system_.node_mass, all);
    const dense::Spectrum energy = dense::spectrum(all.transpose() * steep(all));
    const Index most = std::max<Index>(static_cast<Index>(modal::kMaxLevelColumns) - rigid_ - modes_, 0);
    const Index kept = std::min((energy.values.array() > kMissing).count(), most);
    further_ = all * energy.vectors.rightCols(kept).rowwise().reverse();  // the largest first
    shaped_ = (energy.values.array() > kShaped).count();
    const MatrixXd heavy = fem::mass_times(system_.node_mass, further_);
    for (Index c = 0; c < kept; ++c) further_.col(c) /= std::sqrt(further_.col(c).dot(heavy.col(c)));
    return {};
  }

  // Sets the columns on the skin, and the matrices of the body alone.
  void set_basis(const modal::MassProperties& mass) {
    const Index n = rigid_ + modes_ + further_.cols();
    MatrixXd basis(system_.unknowns(), n);
    on_skin_.resize(3 * plan_.skin.surface.nodes.rows(), n);
    if (rigid_ > 0) {
      on_skin_.leftCols(rigid_) = rigid_motions(mass, plan_.skin.surface.nodes);
      const MatrixXd known = solver_.on_skin(dry_.shapes.leftCols(rigid_));
      const MatrixXd mixing =
          dense::solve_symmetric(known.transpose() * known, known.transpose() * on_skin_.leftCols(rigid_));
      basis.leftCols(rigid_) = dry_.shapes.leftCols(rigid_) * mixing;
    }
    basis.middleCols(rigid_, modes_) = own_;
    basis.rightCols(further_.cols()) = further_;
    on_skin_.rightCols(n - rigid_) = solver_.on_skin(basis.rightCols(n - rigid_));
    levels_.further = on_skin_.rightCols(further_.cols());
    levels_.further.rightCols(std::max<Index>(further_.cols() - shaped_, 0)).setZero();
    const MatrixXd steep = system_.stiffness.selfadjointView<Eigen::Lower>() * basis;
    levels_.stiffness = basis.transpose() * steep;
    levels_.stiffness.topRows(rigid_).setZero();
    levels_.stiffness.leftCols(rigid_).setZero();
    levels_.mass = basis.transpose() * fem::mass_times(system_.node_mass, basis);
    const auto count = static_cast<Index>(plan_.levels.size());
    levels_.level.resize(count);
    levels_.volume.resize(count);
    for (Index l = 0; l < count; ++l) {
      levels_.level[l] = plan_.levels[l].level;
      levels_.volume[l] = plan_.levels[l].volume;
    }
    levels_.drag = MatrixXd::Zero(modes_, count);
    levels_.added.emplace_back(MatrixXd::Zero(n, n));
    giving_.push_back(Giving{MatrixXd::Zero(n, 0), VectorXd()});
  }

  [[nodiscard]] Result<AtLevel> at_level(const WetPart& part) const {
    Result<PartTerms> terms = PartTerms::of(part);
    if (!terms) return fail(terms);
    terms->add_shapes(part, plan_.skin, on_skin_, top_);
    const Index in_reach = terms->count;
    // All of the liquid's modes count, however high. If they ended at a frequency, their number would depend on the
    // level, and splines cannot follow matrices that gain a mode between two levels.
    terms->count = terms->modes->count() - terms->first;
    const MatrixXd mass = part.density * terms->potential.added_mass;
    AtLevel level{.terms = std::move(*terms), .in_reach = in_reach, .added = mass, .bond = {}, .own_lambda = {}};
    level.bond = level.terms.bond(part);
    level.own_lambda = (part.sound_speed * level.terms.wavenumbers()).array().square();
    return level;
  }

  // The boundary layer's part of the decay of the modes that follow those as baked (modal::at_level).
  Result<void> add_drag(std::size_t level, const AtLevel& at) {
    const auto wet = liquid::wet_modes_of({levels_.stiffness, levels_.mass + at.added, at.bond, at.own_lambda});
    if (!wet) return fail(wet);
    const Index count = wet->lambda.size() - rigid_;
    const MatrixXd all = wet->body.rightCols(count), heavy = levels_.mass * all;
    MatrixXd likeness = heavy.middleRows(rigid_, modes_).cwiseAbs();
    for (Index k = 0; k < count; ++k) likeness.col(k) /= std::sqrt(std::max(all.col(k).dot(heavy.col(k)), 1e-300));
    for (Index m = 0; m < modes_; ++m) likeness.row(m) /= std::sqrt(levels_.mass(rigid_ + m, rigid_ + m));
    const MatrixXd rows = likeness.transpose();  // in columns as followers() wants them in rows
    const std::vector<std::size_t> found =
        modal::followers({rows.data(), rows.data() + rows.size()}, body_shares_, static_cast<std::size_t>(count));
    const MatrixXd own = all(Eigen::all, found);
    const MatrixXd liquids = wet->liquid.rightCols(count)(Eigen::all, found);
    levels_.drag.col(static_cast<Index>(level)) =
        at.terms.drag(plan_.levels[level].part, plan_.skin, own, liquids, on_skin_ * own);
    return {};
  }

  // Chooses the motions by which the liquid gives way, and puts them in place of its own modes.
  void follow() {
    const Index n = on_skin_.cols();
    MatrixXd whole = MatrixXd::Zero(n, n);
    for (const Giving& at : giving_)
      whole += top_ * at.bond * at.own_lambda.cwiseInverse().asDiagonal() * at.bond.transpose();
    const dense::Spectrum ways = dense::spectrum(whole / static_cast<double>(giving_.size()));
    // Motions beyond the number of the modes that count depend almost on the others, and splines between levels do not
    // keep that: 12 motions of 7 modes put a mode of the liquid 2.3 cents off, 7 motions 0.03.
    const Index kept = std::min({(ways.values.array() > kGivesWay).count(), kMaxMotions, own_modes_});
    levels_.following = ways.vectors.rightCols(kept);
    for (const Giving& at : giving_) {
      const MatrixXd once = at.own_lambda.cwiseInverse().asDiagonal() * (at.bond.transpose() * levels_.following);
      levels_.bond.emplace_back(at.bond * once);
      levels_.liquid_mass.emplace_back(once.transpose() * once);
    }
  }

  struct Giving {
    MatrixXd bond;
    VectorXd own_lambda;
  };
  const WetPlan& plan_;
  const mesh::Boundary& surface_;
  const solve::Eigenmodes& dry_;
  const fem::System& system_;
  const std::vector<std::int32_t>& clamped_;
  const double top_;
  const Index rigid_, modes_;
  const MatrixXd own_;                     // the wet modes as baked, at the nodes of the system
  const std::vector<double> body_shares_;  // of the strain energy of these modes
  const Progress& progress_;
  const WetSolver solver_;  // for its rows
  MatrixXd further_, on_skin_;
  Index shaped_ = 0, own_modes_ = 0;
  std::vector<Giving> giving_;  // of each level
  WetLevels levels_;
};

void append_packed(const MatrixXd& matrix, double unit, std::vector<float>& to) {
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index j = 0; j <= i; ++j) to.push_back(static_cast<float>(unit * matrix(i, j)));
  }
}

}  // namespace

Result<WetLevels> level_matrices(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                                 const fem::System& system, const std::vector<std::int32_t>& clamped, double top,
                                 const WetBody& wet, const modal::MassProperties& mass, const Progress& progress) {
  return LevelFinder(plan, surface, dry, system, clamped, top, wet, progress).run(mass);
}

std::vector<Index> missing_modes(const WetLevels& levels, const std::vector<LevelColumn>& columns) {
  std::vector<Index> missing;
  for (Index m = 0; m < levels.drag.rows(); ++m) {
    if (std::ranges::find(columns, m, &LevelColumn::mode) == columns.end()) missing.push_back(m);
  }
  return missing;
}

modal::LiquidLevels bank_levels(const WetLevels& levels, const std::vector<LevelColumn>& columns,
                                const MatrixXd& shapes, const LevelUnits& units) {
  const Index further = levels.further.cols(), rigid = levels.mass.rows() - levels.drag.rows() - further;
  std::vector<Index> order;
  std::vector<double> signs;
  const auto add = [&](Index column, double sign) {
    order.push_back(column);
    signs.push_back(sign);
  };
  for (Index k = 0; k < rigid; ++k) add(k, 1);
  for (const LevelColumn& column : columns) add(rigid + column.mode, column.sign);
  for (const Index mode : missing_modes(levels, columns)) add(rigid + mode, 1);
  for (Index k = 0; k < further; ++k) add(levels.mass.rows() - further + k, 1);
  const auto turn = Eigen::Map<const VectorXd>(signs.data(), static_cast<Index>(signs.size()));
  const auto sorted = [&](const MatrixXd& matrix) -> MatrixXd {
    return turn.asDiagonal() * matrix(order, order) * turn.asDiagonal();
  };
  const auto sorted_rows = [&](const MatrixXd& matrix) -> MatrixXd {
    return turn.asDiagonal() * matrix(order, Eigen::all);
  };
  modal::LiquidLevels bank{.rigid = static_cast<std::size_t>(rigid),
                           .further = order.size() - static_cast<std::size_t>(rigid) - columns.size(),
                           .liquid = static_cast<std::size_t>(levels.following.cols())};
  for (Index l = 0; l < levels.level.size(); ++l) {
    bank.level_m.push_back(units.length_m * levels.level[l]);
    bank.volume_m3.push_back(std::pow(units.length_m, 3) * levels.volume[l]);
  }
  for (const double number : shapes.reshaped()) bank.shapes.push_back(static_cast<float>(number));
  append_packed(sorted(levels.stiffness), units.lambda, bank.stiffness);
  append_packed(sorted(levels.mass), 1, bank.mass);
  const auto append_rows = [](const MatrixXd& matrix, double unit, std::vector<float>& to) {
    for (Index i = 0; i < matrix.rows(); ++i) {
      for (Index j = 0; j < matrix.cols(); ++j) to.push_back(static_cast<float>(unit * matrix(i, j)));
    }
  };
  append_rows(sorted_rows(levels.following), 1, bank.following);
  const double drag = 1 / (units.density_kg_m3 * units.length_m);
  for (std::size_t l = 0; l < levels.added.size(); ++l) {
    append_packed(sorted(levels.added[l]), 1, bank.added);
    append_rows(sorted_rows(levels.bond[l]), 1 / units.lambda, bank.bond);
    append_packed(levels.liquid_mass[l], 1 / (units.lambda * units.lambda), bank.liquid_mass);
    for (const LevelColumn& column : columns)
      bank.drag.push_back(static_cast<float>(drag * levels.drag(column.mode, static_cast<Index>(l))));
  }
  return bank;
}

}  // namespace ringdown::bake
