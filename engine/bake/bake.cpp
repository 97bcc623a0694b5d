#include "engine/bake/bake.h"

#include "engine/bake/audibility.h"
#include "engine/bake/body_nonlinear.h"
#include "engine/bake/body_modes.h"
#include "engine/bake/body_shape.h"
#include "engine/bake/fitted_makeup.h"
#include "engine/bake/heard_modes.h"
#include "engine/bake/liquid/level_matrices.h"
#include "engine/bake/sample_points.h"
#include "engine/bake/solve_body.h"
#include "engine/base/range.h"
#include "engine/base/version.h"
#include "engine/bake/tubes/tubes.h"
#include "engine/fem/shape_change.h"
#include "engine/mesh/boundary.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

void add_points(modal::Bank& bank, const mesh::Points& positions) {
  for (const auto& at : positions.cast<float>().rowwise()) bank.positions.push_back({at[0], at[1], at[2]});
}

std::string element_text(fem::Element element) {
  if (element == fem::Element::kTet4Lumped) return "tet4 lumped";
  return std::string(fem::element_name(element)) + " consistent";
}

Result<void> check_options(const BakeOptions& options) {
  if (!(options.band_low_hz >= 0 && options.band_high_hz > options.band_low_hz && options.band_high_hz < 1e9)) {
    return fail(ErrorKind::bad_input, "the band must go from a frequency >= 0 Hz to a higher one");
  }
  if (options.points > 0 && options.points < 4)
    return fail(ErrorKind::bad_input, "a bank needs at least 4 surface points");
  if (!(options.shape_error > 0 && options.shape_error < 1))
    return fail(ErrorKind::bad_input, "the error of shapes must be above 0 and below 1");
  if (options.max_modes < 1) return fail(ErrorKind::bad_input, "a bank needs at least 1 mode");
  if (!(options.floor_db >= 0 && options.floor_db <= 1000))
    return fail(ErrorKind::bad_input, "the floor must be from 0 to 1000 dB");
  return {};
}

// The modes of a body, and those of them that the bank may have.
struct Sounding {
  BodyModes modes;
  std::vector<HeardMode> heard;
  LeftOut left_out;
  double top_hz = 0;        // up to which modes were looked for
  bool above_band = false;  // none lies in the band
  std::vector<modal::ResonatorNote> tubes = {};
  std::vector<CavityMode> cavity = {};
};

tl::unexpected<Error> failed(const std::string& name, const Error& error) {
  return fail(error.kind, name + ": " + error.message);
}

// The modes as a bank at the corners of the surface's elements. With `air` they are taken to radiate as computed.
modal::Bank corner_bank(const Task& task, const std::vector<HeardMode>& heard, const BodyModes& modes,
                        const modal::Air* air) {
  const mesh::Boundary corners = mesh::boundary_of({task.mesh.nodes, task.mesh.elements.leftCols<4>()});
  const Eigen::MatrixXd shapes = shapes_of(heard, modes);
  const auto& surface = task.surface.nodes;
  Eigen::MatrixXd at_corners(3 * static_cast<Eigen::Index>(corners.nodes.size()), shapes.cols());
  mesh::Points positions(static_cast<Eigen::Index>(corners.nodes.size()), 3);
  for (Eigen::Index p = 0; p < positions.rows(); ++p) {
    const Eigen::Index row = std::lower_bound(surface.begin(), surface.end(), corners.nodes[p]) - surface.begin();
    positions.row(p) = task.mesh.nodes.row(corners.nodes[p]);
    at_corners.middleRows<3>(3 * p) = task.units.shape() * shapes.middleRows<3>(3 * row);
  }
  modal::Bank bank;
  add_modes(bank, heard, at_corners, air);
  add_points(bank, positions);
  bank.triangles = corners.triangles;
  return bank;
}

// Returns which modes stay, and in which order. The first `always` of them stay, whatever is heard of them.
Reduced audition(modal::Bank& bank, const Task& task, modal::Bank heard_bank, int always) {
  Reduced reduced =
      reduce(heard_bank, {.floor_db = task.options.floor_db, .keep = task.options.keep_modes, .always = always});
  bank.provenance.dropped_modes = heard_bank.provenance.dropped_modes;
  bank.provenance.floor_db = heard_bank.provenance.floor_db;
  bank.provenance.loss_db = heard_bank.provenance.loss_db;
  return reduced;
}

// Free of units, for the modes in their order. They are chosen for the modes by frequency, so that another order of the
// same modes has the same points.
// Further columns have shapes of their own after those of the modes.
Result<SamplePoints> find_points(const Task& task, const std::vector<HeardMode>& kept, const BodyModes& modes,
                                 const Eigen::MatrixXd& further, const Progress& progress) {
  std::vector<HeardMode> sorted = kept;
  std::sort(sorted.begin(), sorted.end(), [](const HeardMode& a, const HeardMode& b) { return a.number < b.number; });
  Eigen::MatrixXd shapes = shapes_of(sorted, modes);
  const Eigen::Index own = shapes.cols();
  shapes.conservativeResize(Eigen::NoChange, own + further.cols());
  shapes.rightCols(further.cols()) = further;
  Result<SamplePoints> points =
      choose_points(task.unit_mesh, task.surface, shapes,
                    {.shape_error = task.options.shape_error, .points = task.options.points}, progress);
  if (!points) return points;
  std::vector<Eigen::Index> order;
  for (const HeardMode& mode : kept) {
    order.push_back(std::lower_bound(sorted.begin(), sorted.end(), mode.number,
                                     [](const HeardMode& a, Eigen::Index number) { return a.number < number; }) -
                    sorted.begin());
  }
  for (Eigen::Index k = 0; k < further.cols(); ++k) order.push_back(own + k);
  points->shapes = Eigen::MatrixXd(points->shapes(Eigen::all, order));
  order.resize(kept.size());
  points->errors = Eigen::VectorXd(points->errors(order));
  return points;
}

// The relative change of each frequency from the mesh's skin to the body's surface, to first order. Its sign is known,
// but neither this change nor the discretisation's error is exact enough for one to cancel the other.
Eigen::VectorXd shape_errors(const Task& task, const Eigen::VectorXd& gaps_m, const BodyModes& modes) {
  if (gaps_m.size() == 0) return Eigen::VectorXd::Zero(modes.lambda.size());
  const Eigen::VectorXd changes =
      fem::lambda_changes(mesh::face_points(task.unit_mesh), task.surface, gaps_m / task.units.length_m,
                          task.makeup.solid, modes.lambda, modes.shapes);
  return 0.5 * changes.cwiseAbs().cwiseQuotient(modes.lambda);
}

modal::ModeHeat heat_of(const Task& task, const BodyModes& modes, Eigen::Index m) {
  const modal::ModeHeat heat = task.makeup.heat.relaxations(modes.heat, task.units, m);
  return modes.wet ? modal::multiplied(heat, modes.wet->strain[m], 1) : heat;
}

LossOf loss_of(const Task& task, const BodyModes& modes) {
  return [&task, &modes](Eigen::Index m, double lambda, double air_per_s) {
    if (!modes.wet) {
      modal::ModeLoss loss = task.makeup.loss(modes.shares, task.units, m, lambda, air_per_s);
      loss.heat_per_s = modal::heat_loss(heat_of(task, modes, m), std::sqrt(lambda));
      return loss;
    }
    // The liquid strains nothing and has no part in Rayleigh's alpha, but its boundary layer takes energy. Shares of a
    // body of several parts count the body's energy already.
    const bool plain = modes.shares.strain.size() == 0;
    modal::ModeLoss loss = task.makeup.loss(modes.shares, task.units, m, lambda, plain ? 0 : air_per_s);
    if (plain) {
      loss.material_per_s *= modes.wet->strain[m];
      loss.support_per_s = std::max(loss.support_per_s * modes.wet->motion[m] - air_per_s, 0.0);
      loss.air_per_s = air_per_s;
    }
    loss.support_per_s +=
        modes.wet->drag[m] * std::pow(lambda, 0.25) / (task.units.density_kg_m3 * task.units.length_m);
    loss.heat_per_s = modal::heat_loss(heat_of(task, modes, m), std::sqrt(lambda));
    return loss;
  };
}

// Lets every mode radiate, where that was asked for and frequencies are known well enough, and leaves out those that
// the air over-damps. Returns where fields are measured from [m]; nothing where the modes do not radiate.
Result<std::optional<Vec3>> add_radiation(const Task& task, Sounding& sounding, BakeReport& report,
                                          const Progress& progress) {
  auto& [modes, heard, left_out, top_hz, above_band, tubes, cavity] = sounding;
  if (!task.options.air || above_band || heard.empty() || !(report.largest_error <= task.options.radiation_error))
    return std::nullopt;
  Stopwatch watch;
  const modal::Air& air = *task.options.air;
  const Result<Vec3> origin = find_radiation({task.unit_mesh, task.surface, task.units, modes}, air, task.options.cache,
                                             heard, report.radiation, progress);
  if (!origin) return failed(task.name, origin.error());
  std::erase_if(heard, [&, &body = modes, &left = left_out](HeardMode& mode) {
    const double air_per_s = modal::radiation_decay_per_s(modal::rms(mode.field), std::sqrt(mode.lambda), air);
    const bool rings = add_air_loss(mode, loss_of(task, body), air_per_s);
    if (!rings) ++left.over_damped;
    return !rings;
  });
  report.radiation_seconds = watch.lap();
  const BakeOptions& options = task.options;
  if (options.cavity) {
    auto found = find_cavity({task.unit_mesh, task.surface, task.units, modes}, *options.cavity, air, *origin,
                             options.band_low_hz, options.band_high_hz, progress);
    if (!found) return failed(task.name, found.error());
    cavity = std::move(*found);
    report.cavity_seconds = watch.lap();
  }
  if (options.resonators.empty() || heard.empty()) return *origin;
  auto notes = add_tubes({task.unit_mesh, task.surface, task.units, modes}, options.resonators, air, *origin,
                         options.band_high_hz, modes, heard, progress);
  if (!notes) return failed(task.name, notes.error());
  tubes = std::move(*notes);
  report.tube_seconds = watch.lap();
  return *origin;
}

void add_nonlinear(const Task& task, const BodyModes& modes, const std::vector<HeardMode>& kept, Baked& baked) {
  const NonlinearModes& terms = *modes.nonlinear;
  baked.bank.nonlinear = bank_terms(terms, kept, modes, task.units, measure_shape(task.mesh).thickness_m);
  if (baked.bank.nonlinear) baked.bank.nonlinear->coupled = static_cast<std::uint32_t>(task.options.coupled);
  const Eigen::VectorXd own = own_hardening(terms, modes.lambda.head(terms.modes()));
  baked.report.hardening.assign(own.begin(), own.end());
  for (const HeardMode& mode : kept) {
    if (mode.number < terms.modes()) baked.report.hardened.push_back(static_cast<std::size_t>(mode.number));
  }
  std::sort(baked.report.hardened.begin(), baked.report.hardened.end());
  baked.report.membrane_share = terms.membrane_share;
  baked.report.carried_share = terms.carried_share;
}

// The modes up to a frequency, and those of them from the band's lower end on.
Result<Sounding> modes_up_to(double top_hz, const Task& task, const Eigen::VectorXd& gaps_m, BakeReport& report,
                             const Progress& progress) {
  const double top = task.makeup.highest_lambda(top_hz) / task.units.lambda();
  Result<BodyModes> modes = find_body_modes(task, top, report, progress);
  if (!modes) return failed(task.name, modes.error());
  modes->errors += shape_errors(task, gaps_m, *modes);
  Sounding found{.modes = std::move(*modes), .heard = {}, .left_out = {}, .top_hz = top_hz};
  found.heard = modes_in_band(found.modes, task.units, loss_of(task, found.modes), {task.options.band_low_hz, top_hz},
                              found.left_out);
  for (HeardMode& mode : found.heard) mode.heat = heat_of(task, found.modes, mode.number);
  return found;
}

// The lowest modes of a body that rings above the band alone: those within a third of an octave from the first. Nothing
// where none is found.
Result<std::optional<Sounding>> find_above_band(const Task& task, const Eigen::VectorXd& gaps_m, BakeReport& report,
                                                const Progress& progress) {
  constexpr double kStep = 4, kHighest_hz = 1e8, kThird = 1.26;
  for (double top_hz = kStep * task.options.band_high_hz; top_hz < kHighest_hz; top_hz *= kStep) {
    if (!(task.makeup.highest_lambda(top_hz) > 0)) break;
    Result<Sounding> found = modes_up_to(top_hz, task, gaps_m, report, progress);
    if (!found) return fail(found);
    if (found->heard.empty()) continue;
    const double limit_hz = kThird * found->heard.front().mode.frequency_hz;
    std::erase_if(found->heard, [limit_hz](const HeardMode& mode) { return mode.mode.frequency_hz > limit_hz; });
    found->above_band = true;
    return std::move(*found);
  }
  return std::nullopt;
}

// The sentence about a body without a mode in its band.
Error no_mode(const std::string& name, const BakeOptions& options, std::optional<double> lowest_hz) {
  const std::string lowest = lowest_hz ? formatted("; its lowest is at {:.4g} kHz", *lowest_hz / 1000) : "";
  return {
      ErrorKind::bad_input,
      formatted("{} has no mode between {} and {} Hz{}; it may be too small or too large (check the unit of its mesh)",
                name, std::lround(options.band_low_hz), std::lround(options.band_high_hz), lowest)};
}

Result<void> check_request(const modal::Material& material, const BakeOptions& options, const std::string& name) {
  if (auto good = check_options(options); !good) return good;
  if (options.nonlinear > 0 && !options.makeup.moves_freely()) {
    return fail(ErrorKind::bad_input, name +
                                          ": nonlinear terms need a body of one material without grain, glued masses, "
                                          "or supports with stiffness or mass; leave out `nonlinear`, or these");
  }
  if (options.nonlinear > 0 && !options.liquids.none()) {
    return fail(ErrorKind::bad_input, name +
                                          ": nonlinear terms are not found for a body with a liquid; leave "
                                          "`nonlinear` out, or [fill] and [bath]");
  }
  if (options.cavity) {
    const bool live = options.liquids.fill && options.liquids.fill->levels > 0;
    const char* const what = options.nonlinear > 0      ? "`nonlinear`"
                             : live                     ? "`levels`"
                             : !options.air.has_value() ? "`radiation = false`"
                                                        : nullptr;
    if (what != nullptr)
      return fail(ErrorKind::bad_input, name + ": a body with a [cavity] cannot have " + what + "; leave one out");
  }
  if (!options.resonators.empty()) {
    const char* const what = options.nonlinear > 0      ? "`nonlinear`"
                             : !options.liquids.none()  ? "[fill] and [bath]"
                             : !options.air.has_value() ? "`radiation = false`"
                                                        : nullptr;
    if (what != nullptr)
      return fail(ErrorKind::bad_input, name + ": a body with a [[resonator]] cannot have " + what + "; leave one out");
  }
  const fem::Elastic elastic{material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3};
  if (auto good = fem::check_elastic(elastic); !good) return failed(material.name, good.error());
  return {};
}

// Brings the mesh to the element's order, and body and makeup to units without size, modulus and density.
Result<Task> prepare(const mesh::CheckedMesh& checked, const modal::Material& material, const BakeOptions& options,
                     const std::string& name) {
  mesh::TetMesh mesh = mesh::to_order(checked.mesh, fem::order_of(options.element));
  const double length_m = characteristic_length(mesh.nodes);
  if (auto near = check_place(mesh.nodes, length_m); !near) return fail(near.error().kind, name + near.error().message);
  const bool grained = options.makeup.grain && material.orthotropy;
  const BodyUnits units{length_m, grained ? material.orthotropy->youngs_modulus_pa[0] : material.youngs_modulus_pa,
                        material.density_kg_m3};
  mesh::TetMesh unit_mesh{mesh.nodes / length_m, mesh.elements};
  Result<FittedMakeup> makeup = fit_makeup(options.makeup, material, unit_mesh, checked.groups, units, checked.pieces);
  if (!makeup) return failed(name, makeup.error());
  mesh::Boundary surface = mesh::boundary_of(mesh);
  std::optional<WetPlan> wet;
  if (!options.liquids.none()) {
    const WetUnits wet_units{length_m, std::sqrt(units.modulus_pa / units.density_kg_m3), units.density_kg_m3};
    Result<WetPlan> plan = plan_liquids(options.liquids, unit_mesh, surface, wet_units);
    if (!plan) return failed(name, plan.error());
    wet = std::move(*plan);
  }
  return Task{std::move(mesh),    std::move(unit_mesh), std::move(surface), units, material, options, name,
              std::move(*makeup), std::move(wet)};
}

// Finds the modes in the band, or the lowest ones above it where none lies in the band and options.raise_band is set.
Result<Sounding> find_modes(const Task& task, const Eigen::VectorXd& gaps_m, BakeReport& report,
                            const Progress& progress) {
  const BakeOptions& options = task.options;
  if (!(task.makeup.highest_lambda(options.band_high_hz) > 0))
    return fail(ErrorKind::bad_input, task.material.name + " is damped so strongly that no mode rings");
  Result<Sounding> found = modes_up_to(options.band_high_hz, task, gaps_m, report, progress);
  if (!found) return found;
  if (found->modes.nonlinear) {
    if (auto shallow = check_shallow(*found->modes.nonlinear, task.name); !shallow) return fail(shallow);
  }
  const LeftOut& left_out = found->left_out;
  if (!found->heard.empty() || left_out.below_band > 0 || left_out.over_damped > 0) return found;
  if (options.may_be_silent) return found;
  Result<std::optional<Sounding>> above = find_above_band(task, gaps_m, report, progress);
  if (!above) return fail(above);
  if (!*above) return fail(no_mode(task.name, options, {}));
  if (!options.raise_band) return fail(no_mode(task.name, options, (*above)->heard.front().mode.frequency_hz));
  (*above)->left_out = left_out;
  return **std::move(above);
}

void report_modes(const Task& task, const Sounding& sounding, BakeReport& report) {
  report.held = task.makeup.notes;
  report.unknowns = sounding.modes.unknowns;
  report.elements = task.mesh.elements.rows();
  report.rigid = sounding.modes.rigid;
  for (const HeardMode& mode : sounding.heard)
    report.largest_error = std::max(report.largest_error, mode.frequency_error);
}

// Puts the modes in the order of the bank. Returns how many of the first stay in it because they bend the others'
// pitch, however softly they radiate.
int order_modes(const Task& task, Sounding& sounding, const modal::Air* air) {
  auto& [modes, heard, left_out, top_hz, above_band, tubes, cavity] = sounding;
  order_by_importance(heard, corner_bank(task, heard, modes, air), modes, task.units,
                      area_weights(task.surface, task.mesh.nodes));
  if (!modes.nonlinear) return 0;
  const auto rest = std::stable_partition(
      heard.begin(), heard.end(), [&terms = *modes.nonlinear](const HeardMode& m) { return m.number < terms.modes(); });
  return static_cast<int>(rest - heard.begin());
}

void describe_body(const Task& task, const Sounding& sounding, modal::Bank& bank) {
  const Makeup& makeup = task.options.makeup;
  const BodyModes& modes = sounding.modes;
  bank.name = task.name;
  bank.material = task.material;
  if (!makeup.grain) bank.material->orthotropy.reset();
  bank.held = !std::ranges::all_of(makeup.supports, &Support::only_damps);
  bank.mass = task.units.mass(modes.mass);
  bank.provenance = {.generator = std::string("Ringdown ") + kVersion,
                     .element = element_text(task.options.element),
                     .unknowns = modes.unknowns,
                     .rigid_modes = modes.rigid,
                     // A solve that found fewer than it counted has failed. Its top allows for the strongest damping.
                     .counted_modes = modes.rigid + modes.lambda.size() - sounding.left_out.above_band,
                     .band_low_hz = task.options.band_low_hz,
                     .band_high_hz = sounding.top_hz,
                     .largest_residual = modes.residuals.size() > 0 ? modes.residuals.maxCoeff() : 0.0};
  if (modes.wet) {  // the count was of the dry body's
    bank.provenance.counted_modes = 0;
    bank.provenance.liquids = modes.wet->notes;
  }
  bank.provenance.resonators = sounding.tubes;
  for (const Part& part : makeup.parts) bank.provenance.parts.push_back(part.material.name);
}

SolvedBody solved_body(const Task& task, const BodyModes& modes, const std::vector<HeardMode>& kept) {
  const BodyUnits& units = task.units;
  SolvedBody body{.mesh = task.mesh,
                  .shapes = Eigen::MatrixXd(3 * task.mesh.nodes.rows(), static_cast<Eigen::Index>(kept.size())),
                  .node_mass = units.density_kg_m3 * std::pow(units.length_m, 3) * modes.interior->node_mass};
  for (std::size_t m = 0; m < kept.size(); ++m) {
    body.shapes.col(static_cast<Eigen::Index>(m)) =
        sign_of(modes.shapes.col(kept[m].number)) * units.shape() * modes.interior->shapes.col(kept[m].number);
  }
  if (!modes.interior->equations) return body;
  body.equations = modes.interior->equations;
  auto& [system, springs, clamped, rigid] = *body.equations;
  system.stiffness *= units.modulus_pa * units.length_m;
  springs *= units.modulus_pa * units.length_m;
  system.node_mass = body.node_mass;
  rigid *= units.shape();
  return body;
}

// Fills the bank of a body without a mode in its band: the corners of its surface, and its mass.
void fill_silent(const Task& task, const Sounding& sounding, Baked& baked) {
  describe_body(task, sounding, baked.bank);
  modal::Bank corners = corner_bank(task, {}, sounding.modes, nullptr);
  baked.bank.positions = std::move(corners.positions);
  baked.bank.triangles = std::move(corners.triangles);
  if (sounding.modes.interior) baked.body = solved_body(task, sounding.modes, {});
}

// The columns of the bank's modes among those of the liquid's levels; empty where the bank gets no levels.
std::vector<LevelColumn> level_columns(const std::vector<HeardMode>& kept, const BodyModes& modes) {
  std::vector<LevelColumn> columns;
  if (!modes.wet || !modes.wet->levels) return columns;
  for (const HeardMode& mode : kept)
    columns.push_back({mode.number, sign_of(modes.shapes.col(mode.number)) * (mode.turned ? -1 : 1)});
  return columns;
}

// The shapes of the further columns at the surface's nodes, free of units: modes that the bank lacks, and those of the
// further motions that have shapes, which come first.
Eigen::MatrixXd further_shapes(const BodyModes& modes, const std::vector<LevelColumn>& columns) {
  if (columns.empty()) return {modes.shapes.rows(), 0};
  const WetLevels& levels = *modes.wet->levels;
  const std::vector<Eigen::Index> missing = missing_modes(levels, columns);
  const Eigen::Index shaped = (levels.further.colwise().squaredNorm().array() > 0).count();
  Eigen::MatrixXd further(modes.shapes.rows(), static_cast<Eigen::Index>(missing.size()) + shaped);
  further << modes.shapes(Eigen::all, missing), levels.further.leftCols(shaped);
  return further;
}

// Chooses the modes that stay and the sample points, and fills the bank with both. `origin_m` is where the modes
// radiate from, if they do.
Result<void> fill_bank(const Task& task, Sounding& sounding, const std::optional<Vec3>& origin_m, Baked& baked,
                       const Progress& progress) {
  auto& [bank, body, report] = baked;
  const modal::Air* const air = origin_m ? &*task.options.air : nullptr;
  const int bending = order_modes(task, sounding, air);
  describe_body(task, sounding, bank);
  const Reduced reduced = audition(bank, task, corner_bank(task, sounding.heard, sounding.modes, air), bending);
  std::vector<HeardMode> kept;
  for (const std::size_t m : reduced.kept) kept.push_back(sounding.heard[m]);
  const std::vector<LevelColumn> columns = level_columns(kept, sounding.modes);
  const Eigen::MatrixXd further = further_shapes(sounding.modes, columns);
  Result<SamplePoints> points = find_points(task, kept, sounding.modes, further, progress);
  if (!points) return failed(task.name, points.error());
  points->shapes *= task.units.shape();
  add_modes(bank, kept, points->shapes.leftCols(static_cast<Eigen::Index>(kept.size())), air);
  if (!columns.empty()) {
    bank.levels = std::make_shared<const modal::LiquidLevels>(
        bank_levels(*sounding.modes.wet->levels, columns, points->shapes.rightCols(further.cols()),
                    {task.units.length_m, task.units.lambda(), task.units.density_kg_m3}));
  }
  if (origin_m) bank.radiation->maps.origin_m = *origin_m;
  add_points(bank, task.units.length_m * points->positions);
  if (sounding.modes.interior) body = solved_body(task, sounding.modes, kept);
  bank.triangles = points->triangles;
  if (sounding.modes.nonlinear) add_nonlinear(task, sounding.modes, kept, baked);
  for (const double error : points->errors) bank.shape_error.push_back(to_digits(error, 3));
  if (!sounding.cavity.empty()) append_cavity(*task.options.cavity, sounding.cavity, bank);
  report.over_damped = sounding.left_out.over_damped;
  report.below_band = sounding.left_out.below_band;
  report.inaudible = reduced.inaudible;
  report.unimportant = reduced.unimportant;
  return {};
}

}  // namespace

Result<Baked> bake(const mesh::CheckedMesh& checked, const modal::Material& material, const BakeOptions& options,
                   const std::string& name, const Progress& progress) {
  if (auto good = check_request(material, options, name); !good) return fail(good);
  if (progress && !progress("assemble", 0)) return fail_cancelled();
  const Result<Task> task = prepare(checked, material, options, name);
  if (!task) return fail(task);
  Baked baked;
  Result<Sounding> sounding = find_modes(*task, checked.gaps_m, baked.report, progress);
  if (!sounding) return fail(sounding);
  report_modes(*task, *sounding, baked.report);
  const Result<std::optional<Vec3>> origin_m = add_radiation(*task, *sounding, baked.report, progress);
  if (!origin_m) return fail(origin_m);
  if (sounding->heard.empty()) {
    if (!options.may_be_silent) return fail(no_mode(name, options, {}));
    fill_silent(*task, *sounding, baked);
    return baked;
  }
  if (progress && !progress("finish", 0)) return fail_cancelled();
  Stopwatch watch;
  if (auto filled = fill_bank(*task, *sounding, *origin_m, baked, progress); !filled) return fail(filled);
  baked.report.finish_seconds = watch.lap();
  return baked;
}

}  // namespace ringdown::bake
