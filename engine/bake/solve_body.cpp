#include "engine/bake/solve_body.h"

#include "engine/bake/body_nonlinear.h"
#include "engine/bake/body_shape.h"
#include "engine/bake/liquid/level_matrices.h"
#include "engine/fem/error_estimate.h"
#include "engine/fem/heat_flow.h"
#include "engine/solve/eigensolver.h"

#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

using solve::Eigenmodes;

// The band of a rescaled body differs in its last bits. The headroom lets modes from the cache cover it all the same.
constexpr double kHeadroom = 1 + 1e-9;

// The largest |lambda| of a rigid motion, which is 0 but for rounding: so large is the rounding error of any lambda.
double rounding_of(const Eigenmodes& modes) {
  return modes.rigid > 0 ? modes.lambda.head(modes.rigid).cwiseAbs().maxCoeff() : 0.0;
}

// A mesh whose pieces hold together by faces (check_mesh) has six rigid motions for each, and no others; `free` of them
// are left by what holds the body.
Result<void> check_rigid(const Eigenmodes& modes, int free, double highest_lambda) {
  constexpr double kMinContrast = 10;
  const bool vibrates = modes.lambda.size() > modes.rigid;
  const double lowest = vibrates ? modes.lambda[modes.rigid] : highest_lambda;
  if (modes.rigid == free && lowest > kMinContrast * rounding_of(modes)) return {};
  return fail(ErrorKind::bad_input,
              "its lowest vibration cannot be told from rigid motions because of rounding; its elements are too flat "
              "or too distorted: mesh the object again");
}

BodyModes on_surface(const Eigenmodes& modes, const Eigen::MatrixXd& shapes, const mesh::Boundary& surface) {
  const Eigen::Index elastic = modes.lambda.size() - modes.rigid;
  BodyModes body{.lambda = modes.lambda.tail(elastic),
                 .shapes = Eigen::MatrixXd(3 * static_cast<Eigen::Index>(surface.nodes.size()), elastic),
                 .residuals = modes.residuals.tail(elastic),
                 .rigid = modes.rigid};
  for (Eigen::Index m = 0; m < elastic; ++m) {
    for (std::size_t p = 0; p < surface.nodes.size(); ++p) {
      body.shapes.col(m).segment<3>(3 * static_cast<Eigen::Index>(p)) =
          shapes.col(modes.rigid + m).segment<3>(3 * surface.nodes[p]);
    }
  }
  return body;
}

// True if some material says how it warms. In linear elements the pressure does not follow a bent wall, so they have no
// heat.
bool heat_counts(const Task& task) { return task.makeup.heat.reference && fem::order_of(task.options.element) > 1; }

// Replaces dry modes and their errors by those with the liquids, up to `top`. `all` has the dry shapes at every node.
Result<void> add_liquids(const Task& task, const fem::System& moving, const std::vector<std::int32_t>& clamped,
                         double top, const modal::MassProperties& mass, Eigenmodes& modes, Eigen::VectorXd& errors,
                         std::optional<WetEffects>& effects, const Progress& progress) {
  Result<WetBody> wet = wet_body(*task.wet, task.surface, modes, moving, clamped, top, progress);
  if (!wet) return fail(wet);
  if (!task.wet->levels.empty()) {
    auto levels = level_matrices(*task.wet, task.surface, modes, moving, clamped, top, *wet, mass, progress);
    if (!levels) return fail(levels);
    wet->effects.levels = std::move(*levels);
  }
  // Each dry mode errs by its share of the strain.
  const Eigen::VectorXd weighed = modes.lambda.tail(errors.size()).cwiseProduct(errors);
  modes = std::move(wet->modes);
  const Eigen::VectorXd lambda = modes.lambda.tail(modes.lambda.size() - modes.rigid);
  const Eigen::MatrixXd shares = wet->mixing.bottomRows(errors.size()).cwiseAbs2();
  errors = (shares.transpose() * weighed).cwiseQuotient(lambda) + wet->effects.errors;
  effects = std::move(wet->effects);
  return {};
}

Result<BodyModes> solve_body(const Task& task, const solve::EigenRequest& request, double top, BakeReport& report,
                             const Progress& progress) {
  Stopwatch watch;
  const fem::Holding& holding = task.makeup.holding;
  Result<fem::System> system = fem::assemble(task.unit_mesh, task.makeup.solid, task.options.element);
  if (!system) return fail(task.material.name, system);
  Equations equations;
  if (task.options.equations) equations.springs = system->stiffness;
  fem::add_layers(task.unit_mesh, holding, *system);
  const std::vector<std::int32_t> clamped = fem::nodes_on(task.unit_mesh, holding.clamped);
  fem::System left;
  if (!clamped.empty()) fem::remove_nodes(clamped, *system, left);
  const fem::System& moving = clamped.empty() ? *system : left;
  if (moving.unknowns() == 0)
    return fail(ErrorKind::bad_input, "its supports clamp the whole body, so nothing can move");
  report.assemble_seconds = watch.lap();

  const double highest_lambda = request.highest_lambda * task.units.lambda();
  const modal::Material guess = task.options.makeup.grain ? isotropic_stand_in(task.material) : task.material;
  if (auto few = check_count(measure_shape(task.mesh).volume_m3, guess, highest_lambda, task.options.band_high_hz,
                             task.options.max_modes);
      !few)
    return fail(few);
  Result<Eigenmodes> modes = solve::solve_modes(moving, request, progress);
  if (!modes) return fail(modes);
  report.agreement = modes->agreement;
  report.factor_seconds = modes->factor_seconds;
  report.iterate_seconds = modes->iterate_seconds;
  if (auto rigid = check_rigid(*modes, task.makeup.free_motions, request.highest_lambda); !rigid) return fail(rigid);

  Eigen::MatrixXd expanded = clamped.empty() ? Eigen::MatrixXd() : fem::with_nodes(modes->shapes, clamped);
  const Eigen::MatrixXd& shapes = clamped.empty() ? modes->shapes : expanded;
  const Eigen::Index dry = modes->lambda.size() - modes->rigid;
  watch.lap();
  if (progress && !progress("errors", 0)) return fail_cancelled();
  Result<Eigen::VectorXd> errors = fem::frequency_errors(task.unit_mesh, task.makeup.solid, modes->lambda.tail(dry),
                                                         shapes.rightCols(dry), 0, holding);
  if (!errors) return fail(errors);
  *errors += rounding_of(*modes) * modes->lambda.tail(dry).cwiseInverse();
  report.estimate_seconds = watch.lap();
  const modal::MassProperties mass = mass_properties(task.unit_mesh, system->node_mass);
  std::optional<WetEffects> wet;
  if (task.wet) {
    if (auto added = add_liquids(task, moving, clamped, top, mass, *modes, *errors, wet, progress); !added)
      return fail(added);
    if (!clamped.empty()) expanded = fem::with_nodes(modes->shapes, clamped);
    report.liquid_seconds = watch.lap();
  }
  BodyModes body = on_surface(*modes, shapes, task.surface);
  body.errors = std::move(*errors);
  body.wet = std::move(wet);
  const auto elastic = shapes.rightCols(body.lambda.size());
  body.shares = task.makeup.shares(task.unit_mesh, elastic);
  if (heat_counts(task) && body.lambda.size() > 0) {
    const double wall = measure_shape(task.mesh).thickness_m / task.units.length_m;
    auto pairs = fem::heat_relaxations(
        {task.unit_mesh, task.makeup.solid, task.makeup.heat.parts, task.makeup.part_of, wall}, elastic,
        body.wet ? body.lambda.cwiseProduct(body.wet->strain).eval() : body.lambda, progress);
    if (!pairs) return fail(pairs);
    body.heat = std::move(*pairs);
  }
  report.heat_seconds = watch.lap();
  body.complete_to = task.wet ? top : request.highest_lambda;
  body.verified = request.verify;
  body.unknowns = moving.unknowns();
  body.mass = mass;
  if (task.options.interior) body.interior = {elastic, system->node_mass};
  if (task.options.interior && task.options.equations) {
    equations.springs.swap(system->stiffness);  // now the body's own stiffness is in `system`
    equations.springs = holding.layers.empty() ? fem::SparseMatrix() : equations.springs - system->stiffness;
    equations.system = *system;
    if (!holding.layers.empty()) system->stiffness += equations.springs;
    equations.clamped = clamped;
    equations.rigid = shapes.leftCols(modes->rigid);
    body.interior->equations = std::move(equations);
  }
  if (task.options.nonlinear > 0 && body.lambda.size() > 0) {
    watch.lap();
    const int count = std::min(task.options.nonlinear, static_cast<int>(body.lambda.size()));
    const fem::Elastic& law = task.makeup.solid.laws().front().elastic;  // of a plain body the only one
    Result<NonlinearModes> nonlinear =
        find_nonlinear(task.unit_mesh, law, *system, modes->lambda, modes->shapes, modes->rigid, count, progress);
    if (!nonlinear) return fail(nonlinear);
    body.nonlinear = std::move(*nonlinear);
    report.nonlinear_seconds = watch.lap();
  }
  return body;
}

}  // namespace

// The modes of the body up to `top`: from the cache, or solved and put there.
Result<BodyModes> find_body_modes(const Task& task, double top, BakeReport& report, const Progress& progress) {
  const double reach = task.wet ? kDryBand * kDryBand : 1;
  solve::EigenRequest request{.highest_lambda = kHeadroom * reach * top,
                              .max_modes = task.options.max_modes,
                              .method = task.options.solver,
                              .rigid = task.makeup.free_motions,
                              .processes = task.options.processes,
                              .verify = task.options.verify,
                              .unit_hz = std::sqrt(task.units.lambda())};
  const auto in_band = [top](BodyModes modes) { return up_to(std::move(modes), top); };
  if (task.options.cache.empty() || task.wet) return solve_body(task, request, top, report, progress).map(in_band);

  const ModeCache cache{ContentCache(task.options.cache)};
  const BodyQuestion question{task.unit_mesh,       task.surface.nodes.size(),
                              task.options.element, task.material.poisson_ratio,
                              request.tolerance,    task.makeup.key};
  auto kept = task.options.interior ? std::nullopt : cache.find(question, top, request.max_modes);
  const NonlinearCache terms{ContentCache(task.options.cache)};
  if (kept && task.options.nonlinear > 0) kept->nonlinear = terms.find(*kept, task.options.nonlinear);
  if (kept && kept->errors.size() == kept->lambda.size() && (kept->verified || !request.verify) &&
      (kept->nonlinear || task.options.nonlinear == 0) &&
      (kept->heat.size() > 0 || kept->lambda.size() == 0 || !heat_counts(task))) {
    report.from_cache = true;
    return std::move(*kept);
  }
  // A plan by what earlier bakes found changes the last bits of modes, which the cache would then keep. A body that is
  // solved at each bake is planned without, so that its bank repeats.
  if (!task.options.interior) request.expected_lambda = cache.expected(question, task.options.family);
  Result<BodyModes> modes = solve_body(task, request, top, report, progress);
  if (!modes) return modes;
  const Result<void> stored = cache.store(question, *modes);
  if (!stored) report.cache_trouble = stored.error().message;
  if (stored) (void)cache.expect(question, task.options.family, modes->lambda);
  BodyModes body = in_band(std::move(*modes));
  if (body.nonlinear && body.nonlinear->modes() <= body.lambda.size()) (void)terms.store(body, *body.nonlinear);
  return body;
}

}  // namespace ringdown::bake
