#include "engine/bake/liquid/fill_bank.h"

#include "engine/bake/liquid/wet_body.h"
#include "engine/liquid/potential.h"
#include "engine/liquid/water_modes.h"
#include "engine/liquid/wet_modes.h"
#include "engine/materials/importance.h"
#include "engine/modal/hearing/loudness.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSamePitch = 5e-4;         // relative, of two modes of the dry body that count as a pair
constexpr double kSplit = 0.03;             // of the mass of a pair, that panels without its symmetry may cause
constexpr std::array kShares = {0.5, 0.8};  // of the highest dry frequency, up to which smaller bases reach
constexpr double kMinOwnShare = 0.5;        // of a mode's amplitudes squared
constexpr double kNetFlow = 0.004;  // of the mean of the squared flow: a mode that pushes the liquid up and down
constexpr double kMapError_db = 3;  // stated of fields that are mixed from those of the dry body

mesh::TriangleMesh surface_of(const modal::Bank& bank) {
  mesh::TriangleMesh surface;
  surface.nodes.resize(static_cast<Index>(bank.point_count()), 3);
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const auto& [x, y, z] = bank.positions[p];
    surface.nodes.row(static_cast<Index>(p)) << x, y, z;
  }
  surface.triangles.resize(static_cast<Index>(bank.triangles.size()), 3);
  for (std::size_t t = 0; t < bank.triangles.size(); ++t) {
    const auto& [a, b, c] = bank.triangles[t];
    surface.triangles.row(static_cast<Index>(t)) << static_cast<std::int32_t>(a), static_cast<std::int32_t>(b),
        static_cast<std::int32_t>(c);
  }
  return surface;
}

// The rigid motions of unit mass at the bank's points, 3P x 6: along the axes, and about the principal ones.
MatrixXd rigid_motions(const modal::MassProperties& mass, const mesh::TriangleMesh& surface) {
  const auto& [x, y, z, w] = mass.orientation;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  const Vector3d center(mass.center_of_mass_m.x, mass.center_of_mass_m.y, mass.center_of_mass_m.z);
  const std::array inertia = {mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
  MatrixXd motions(3 * surface.nodes.rows(), 6);
  for (Index p = 0; p < surface.nodes.rows(); ++p) {
    const Vector3d arm = surface.nodes.row(p).transpose() - center;
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(3 * p, axis) = Vector3d::Unit(axis) / std::sqrt(mass.mass_kg);
      motions.block<3, 1>(3 * p, 3 + axis) = turn.col(axis).cross(arm) / std::sqrt(inertia[axis]);
    }
  }
  return motions;
}

Result<void> check(const modal::Bank& bank) {
  const char* const why = bank.triangles.empty()                ? "it has no surface"
                          : bank.nonlinear                      ? "its modes bend each other's pitch"
                          : !bank.provenance.liquids.empty()    ? "it has a liquid already"
                          : !bank.provenance.resonators.empty() ? "it has a tube"
                          : bank.cavity                         ? "its air has modes of its own"
                          : !bank.held && !bank.mass            ? "it does not state its mass and inertia"
                                                                : nullptr;
  if (why != nullptr) return fail(ErrorKind::bad_input, std::string("the bank cannot be filled: ") + why);
  return {};
}

// One body of liquid in the basis of the bank's motions.
struct Part {
  liquid::Potential potential;
  std::optional<liquid::WaterModes> modes;
  MatrixXd flow, bound, error;
  Index first = 0, count = 0, row = 0;
};

// Wet modes in the basis of some of the dry ones.
struct Smaller {
  std::vector<Index> basis;
  liquid::WetModes modes;
};

class BankFiller {
 public:
  BankFiller(const modal::Bank& bank, WetPlan plan) : bank_(bank), plan_(std::move(plan)) {
    const auto modes = static_cast<Index>(bank.mode_count()), points = static_cast<Index>(bank.point_count());
    const MatrixXd rigid = bank.held ? MatrixXd(3 * points, 0) : rigid_motions(*bank.mass, plan_.skin.surface);
    rigid_ = rigid.cols();
    shapes_.resize(3 * points, rigid_ + modes);
    shapes_.leftCols(rigid_) = rigid;
    lambda_ = VectorXd::Zero(rigid_ + modes);
    for (Index m = 0; m < modes; ++m) {
      for (Index p = 0; p < points; ++p) {
        const auto& [x, y, z] = bank.shape(m, p);
        shapes_.block<3, 1>(3 * p, rigid_ + m) << x, y, z;
      }
      lambda_[rigid_ + m] = modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    }
  }

  Result<FilledBank> run() {
    if (auto found = find_parts(); !found) return fail(found);
    std::vector<Index> all(static_cast<std::size_t>(lambda_.size()));
    std::iota(all.begin(), all.end(), 0);
    const Result<liquid::WetModes> wet = solve(all);
    if (!wet) return fail(wet);
    // Smaller bases show how far a mode depends on dry modes that are left out.
    std::vector<Smaller> smaller;
    for (const double share : kShares) {
      Smaller one;
      for (const Index m : all) {
        if (lambda_[m] <= share * share * lambda_.maxCoeff()) one.basis.push_back(m);
      }
      Result<liquid::WetModes> modes = solve(one.basis);
      if (!modes) return fail(modes);
      one.modes = std::move(*modes);
      smaller.push_back(std::move(one));
    }
    return filled(*wet, smaller);
  }

 private:
  Result<void> find_parts() {
    const double highest = kLiquidBand * std::sqrt(lambda_.maxCoeff());
    for (const WetPart& wet : plan_.parts) {
      const Result<liquid::WetPanels> panels = liquid::WetPanels::of(wet.wetted);
      if (!panels) return fail(panels);
      const Result<liquid::WetPanels> coarse =
          liquid::WetPanels::of(wet.wetted, static_cast<int>(liquid::kWetNodes / kFewer));
      if (!coarse) return fail(coarse);
      const MatrixXd flow = liquid::flow_of(wet.wetted, plan_.skin, shapes_);
      Part part{.potential = panels->potential_of(flow), .modes = {}, .flow = flow, .bound = {}, .error = {}};
      MatrixXd& mass = part.potential.added_mass;
      part.error = wet.density / (kFewer - 1) * (mass - coarse->potential_of(flow).added_mass);
      part.error += wet.density * facet_share(wet.wetted) * mass;
      join_pairs(mass);
      part.modes.emplace(wet.wetted, panels->panels());
      part.bound = flow.transpose() * part.modes->values(wet.wetted.at);
      part.first = wet.wetted.open ? 0 : 1;
      part.count =
          std::max<Index>((part.modes->wavenumbers().array() <= highest / wet.sound_speed).count() - part.first, 0);
      part.row = oscillators_;
      oscillators_ += part.count;
      parts_.push_back(std::move(part));
      panels_.push_back(*panels);
    }
    return {};
  }

  // The share of the mass that flat triangles in place of a round wall may add or miss: with half an angle alpha
  // between neighbours, the polygon is smaller by alpha^2 / 3 and its flow larger by alpha^2 / 2, each to be squared.
  [[nodiscard]] double facet_share(const liquid::Wetted& wetted) const {
    const mesh::TriangleMesh& surface = plan_.skin.surface;
    MatrixXd at_nodes = MatrixXd::Zero(surface.nodes.rows(), 3);
    std::vector<Vector3d> twice;
    for (const Index t : wetted.triangles) {
      const auto node = [&](int i) -> Vector3d { return surface.nodes.row(surface.triangles(t, i)).transpose(); };
      twice.push_back((node(1) - node(0)).cross(node(2) - node(0)));
      for (int i = 0; i < 3; ++i) at_nodes.row(surface.triangles(t, i)) += twice.back().transpose();
    }
    double sum = 0, area = 0;
    for (std::size_t t = 0; t < twice.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const Vector3d normal = at_nodes.row(surface.triangles(wetted.triangles[t], i)).transpose().normalized();
        sum += (twice[t].norm() - twice[t].dot(normal)) / 3;  // 1 - cos alpha = alpha^2 / 2
      }
      area += twice[t].norm();
    }
    return 2 * sum / (3 * area);
  }

  // Gives both modes of a pair the same mass. A round body has pairs, and irregular panels would split them by a beat
  // that is heard; a difference that is the body's own is larger.
  void join_pairs(MatrixXd& mass) const {
    std::vector<Index> order(static_cast<std::size_t>(lambda_.size() - rigid_));
    std::iota(order.begin(), order.end(), rigid_);
    std::ranges::sort(order, {}, [&](Index m) { return lambda_[m]; });
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      const Index a = order[i], b = order[i + 1];
      const double mean = (mass(a, a) + mass(b, b)) / 2;
      if (std::sqrt(lambda_[b] / lambda_[a]) - 1 > kSamePitch) continue;
      if (std::hypot(mass(a, a) - mass(b, b), 2 * mass(a, b)) > kSplit * mean) continue;
      mass(a, a) = mass(b, b) = mean;
      mass(a, b) = mass(b, a) = 0;
      ++i;
    }
  }

  // The wet modes in the basis of some of the dry ones, and of all of the liquid's.
  [[nodiscard]] Result<liquid::WetModes> solve(const std::vector<Index>& basis) const {
    const auto n = static_cast<Index>(basis.size());
    liquid::Coupled coupled;
    coupled.stiffness = MatrixXd(lambda_(basis).asDiagonal());
    coupled.mass = MatrixXd::Identity(n, n);
    coupled.bond.resize(n, oscillators_);
    coupled.own_lambda.resize(oscillators_);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      const WetPart& wet = plan_.parts[p];
      coupled.mass += wet.density * part.potential.added_mass(basis, basis);
      const MatrixXd bound = part.bound(basis, Eigen::all);
      if (part.first == 1)
        coupled.stiffness += wet.density * wet.sound_speed * wet.sound_speed * bound.col(0) * bound.col(0).transpose();
      if (part.count == 0) continue;
      const VectorXd kappa = part.modes->wavenumbers().segment(part.first, part.count);
      coupled.own_lambda.segment(part.row, part.count) = (wet.sound_speed * kappa).array().square();
      coupled.bond.middleCols(part.row, part.count) =
          std::sqrt(wet.density) * bound.middleCols(part.first, part.count) * kappa.cwiseInverse().asDiagonal();
    }
    return liquid::wet_modes_of(coupled);
  }

  // The relative change of a wet mode's frequency in the smallest basis that has most of the mode: the nearest of the
  // modes there that are like it, since those of a pair may be turned against each other.
  [[nodiscard]] static double change_of(const liquid::WetModes& wet, Index mode, const std::vector<Smaller>& smaller) {
    for (const Smaller& one : smaller) {
      const VectorXd own = wet.body.col(mode)(one.basis);
      if (own.squaredNorm() < kMinOwnShare * wet.body.col(mode).squaredNorm()) continue;
      const VectorXd likeness = (one.modes.body.transpose() * own).cwiseAbs();
      double change = HUGE_VAL;
      for (Index other = 0; other < likeness.size(); ++other) {
        if (likeness[other] < 0.5 * likeness.maxCoeff()) continue;
        change = std::min(change, std::abs(std::sqrt(std::max(one.modes.lambda[other], 0.0) / wet.lambda[mode]) - 1));
      }
      return change;
    }
    return HUGE_VAL;
  }

  Result<FilledBank> filled(const liquid::WetModes& wet, const std::vector<Smaller>& smaller) const {
    FilledBank result;
    modal::Bank modes = emptied();
    for (Index k = rigid_; k < wet.lambda.size(); ++k) {
      const VectorXd own = wet.body.col(k);
      const VectorXd strain = lambda_.cwiseProduct(own.cwiseAbs2()) / wet.lambda[k];
      double error = change_of(wet, k, smaller);
      for (const Part& part : parts_) error += std::abs(0.5 * own.dot(part.error * own));
      for (Index m = 0; m < strain.size() - rigid_; ++m) {
        const auto mode = static_cast<std::size_t>(m);
        if (!bank_.frequency_error.empty()) error += strain[rigid_ + m] * bank_.frequency_error[mode];
      }
      const double band = modal::hz_to_rad_per_s(bank_.provenance.band_high_hz);
      if (wet.lambda[k] > std::min(lambda_.maxCoeff(), band > 0 ? band * band : HUGE_VAL)) break;
      if (!(error <= kMaxFillError) || pumps(own)) {
        ++result.left_out;
        continue;
      }
      if (!add(wet, k, strain, error, modes)) ++result.left_out;
    }
    if (modes.mode_count() == 0)
      return fail(ErrorKind::bad_input, "no mode of the filled bank is known well enough; bake the object with [fill]");
    result.bank = ordered(modes);
    return result;
  }

  // A mode of a round vessel that does not change around it moves the whole column of liquid. Few dry modes have its
  // pattern, and even large bases miss it by several percent.
  [[nodiscard]] bool pumps(const VectorXd& own) const {
    constexpr double kMoves = 1e-3;  // share of the energy in the liquid
    return std::ranges::any_of(parts_, [&](const Part& part) {
      const WetPart& wet = plan_.parts[static_cast<std::size_t>(&part - parts_.data())];
      if (wet.density * own.dot(part.potential.added_mass * own) < kMoves) return false;
      const VectorXd flow = part.flow * own;
      return std::pow(flow.sum(), 2) >
             kNetFlow * wet.wetted.areas.sum() * (flow.array().square() / wet.wetted.areas.array()).sum();
    });
  }

  [[nodiscard]] modal::Bank emptied() const {
    modal::Bank bank = bank_;
    bank.frequency_hz.clear(), bank.decay_per_s.clear(), bank.losses.clear(), bank.heat.clear();
    bank.frequency_error.clear(), bank.shape_error.clear(), bank.shapes.clear();
    bank.pitch_hz.reset();
    bank.fracture.reset();
    if (bank.radiation)
      bank.radiation->maps.modes.clear(), bank.radiation->error_db.clear(), bank.radiation->reason.clear();
    bank.provenance.liquids = plan_.notes;
    bank.provenance.counted_modes = 0;
    return bank;
  }

  // Returns false for a mode that the liquid's friction over-damps.
  bool add(const liquid::WetModes& wet, Index k, const VectorXd& strain, double error, modal::Bank& to) const {
    const VectorXd own = wet.body.col(k);
    const double omega = std::sqrt(wet.lambda[k]);
    modal::ModeLoss loss;
    for (std::size_t m = 0; m < bank_.mode_count(); ++m) {
      const Index at = rigid_ + static_cast<Index>(m);
      const modal::ModeLoss dry =
          bank_.losses.empty() ? modal::ModeLoss{.material_per_s = bank_.decay_per_s[m]} : bank_.losses[m];
      const double flexed = strain[at] * omega / std::sqrt(lambda_[at]);  // the loss factor stays
      loss.material_per_s += flexed * dry.material_per_s;
      loss.heat_per_s += flexed * dry.heat_per_s;
      loss.support_per_s += own[at] * own[at] * dry.support_per_s;
    }
    loss.support_per_s += drag_of(wet, k, omega);
    modal::FarField field;
    if (bank_.radiation) {
      field = field_of(own, omega);
      loss.air_per_s = modal::radiation_decay_per_s(modal::rms(field), omega, bank_.radiation->air);
    }
    const modal::DampedMode mode = modal::with_decay(wet.lambda[k], loss.total_per_s());
    if (!(mode.frequency_hz > 0)) return false;
    if (bank_.radiation) {
      to.radiation->maps.modes.push_back(std::move(field));
      to.radiation->error_db.push_back(kMapError_db);
      to.radiation->reason.emplace_back("the field is mixed from those of the dry body");
    }
    to.frequency_hz.push_back(mode.frequency_hz);
    to.decay_per_s.push_back(mode.decay_per_s);
    to.losses.push_back(loss);
    to.frequency_error.push_back(error);
    const VectorXd shape = shapes_ * own;
    for (Index row = 0; row < shape.size(); row += 3)
      to.shapes.push_back(
          {static_cast<float>(shape[row]), static_cast<float>(shape[row + 1]), static_cast<float>(shape[row + 2])});
    return true;
  }

  [[nodiscard]] modal::FarField field_of(const VectorXd& own, double omega) const {
    const double k = omega / bank_.radiation->air.sound_speed_m_s;
    std::map<std::size_t, std::complex<double>> terms;
    std::size_t highest = 0;
    for (std::size_t m = 0; m < bank_.mode_count(); ++m) {
      const modal::FarField& dry = bank_.radiation->maps.modes[m];
      const double share = own[rigid_ + static_cast<Index>(m)] * modal::level_ratio(dry, k);
      for (const modal::FarField::Term& term : dry.terms) {
        terms[term.harmonic] += share * std::complex<double>(term.value);
        highest = std::max<std::size_t>(highest, term.harmonic);
      }
    }
    std::vector<std::complex<double>> values(highest + 1);
    for (const auto& [harmonic, value] : terms) values[harmonic] = value;
    return {.wavenumber_rad_m = k, .terms = modal::terms_of(values, 1e-4), .levels = {}};
  }

  // The loss by the boundary layer at the wall, as in WetSolver::add_drag.
  [[nodiscard]] double drag_of(const liquid::WetModes& wet, Index k, double omega) const {
    using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
    double drag = 0;
    const VectorXd own = wet.body.col(k), motion = shapes_ * own;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      const liquid::Wetted& wetted = plan_.parts[p].wetted;
      const MatrixXd nodes = part.potential.nodes * own;
      MatrixXd swings = MatrixXd::Zero(wetted.at.rows(), 3);
      if (part.count > 0) {
        const VectorXd kappa = part.modes->wavenumbers().segment(part.first, part.count);
        const VectorXd amplitudes =
            wet.liquid.col(k).segment(part.row, part.count).cwiseQuotient(std::sqrt(plan_.parts[p].density) * kappa);
        const std::array<MatrixXd, 3> slopes = part.modes->slopes(wetted.at);
        for (int axis = 0; axis < 3; ++axis)
          swings.col(axis) = slopes[axis].middleCols(part.first, part.count) * amplitudes;
      }
      for (Index s = 0; s < wetted.at.rows(); ++s) {
        Vector3d moved = Vector3d::Zero();
        for (Rows::InnerIterator node(plan_.skin.samples.interpolation, wetted.samples[s]); node; ++node)
          moved += node.value() * motion.segment<3>(3 * node.col());
        Vector3d slip = panels_[p].slope_at(s, nodes).col(0) + swings.row(s).transpose() - wetted.turn * moved;
        const Vector3d normal = wetted.normals.row(s).transpose();
        slip -= normal * normal.dot(slip);
        drag += 0.5 * plan_.parts[p].drag_si * std::sqrt(omega) * wetted.areas[s] * slip.squaredNorm();
      }
    }
    return drag;
  }

  // The modes by their importance to the ear.
  [[nodiscard]] static modal::Bank ordered(const modal::Bank& bank) {
    const modal::Loudness loudness(bank);
    const std::size_t points = bank.point_count();
    std::vector<double> importances;
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      double squares = 0;
      for (std::size_t p = 0; p < points; ++p) {
        for (const float x : bank.shape(m, p)) squares += x * x;
      }
      importances.push_back(importance({bank.frequency_hz[m], bank.decay_per_s[m]},
                                       loudness.pressure_pa(bank, m, {}, bank.frequency_hz[m]),
                                       std::sqrt(squares / static_cast<double>(points))));
    }
    std::vector<std::size_t> order(bank.mode_count());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return importances[a] > importances[b]; });
    modal::Bank sorted = bank;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t m = order[i];
      sorted.frequency_hz[i] = bank.frequency_hz[m];
      sorted.decay_per_s[i] = bank.decay_per_s[m];
      sorted.losses[i] = bank.losses[m];
      sorted.frequency_error[i] = bank.frequency_error[m];
      std::copy_n(bank.shapes.begin() + static_cast<std::ptrdiff_t>(m * points), points,
                  sorted.shapes.begin() + static_cast<std::ptrdiff_t>(i * points));
      if (bank.radiation) sorted.radiation->maps.modes[i] = bank.radiation->maps.modes[m];
    }
    return sorted;
  }

  const modal::Bank& bank_;
  const WetPlan plan_;
  Index rigid_ = 0, oscillators_ = 0;
  MatrixXd shapes_;  // 3P x n: rigid motions, then the bank's modes
  VectorXd lambda_;  // n
  std::vector<Part> parts_;
  std::vector<liquid::WetPanels> panels_;
};

}  // namespace

Result<FilledBank> fill_bank(const modal::Bank& bank, const Filling& filling) {
  if (auto good = check(bank); !good) return fail(good);
  WetPlan plan{.skin = liquid::flat_skin(surface_of(bank)), .parts = {}, .air = {}, .notes = {}};
  if (auto planned = plan_filling(filling, WetUnits{}, plan); !planned) return fail(planned);
  return BankFiller(bank, std::move(plan)).run();
}

}  // namespace ringdown::bake
