#include "engine/bake/tuning/tune_object.h"

#include "engine/bake/bake_object.h"
#include "engine/base/range.h"
#include "engine/materials/material_library.h"
#include "engine/modal/levels/level_bank.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::VectorXd;

constexpr double kBandAbove = 1.8, kBandBelow = 0.3;  // of the highest and the lowest target
constexpr double kCoarseTolerance_cents = 3;
constexpr int kMaxCoarseBakes = 25, kMaxBakes = 60;
constexpr double kRefinement = 0.7;          // of the mesh size, from round to round
constexpr std::size_t kSearchedLevels = 16;  // unless the object states its own number
constexpr int kSearchedNodes = 500;          // of the liquid's wall
constexpr double kSearchTolerance = 0.1;     // of the tolerance, between levels
constexpr int kMaxLevelBakes = 5;            // at levels found

double cents_between(double frequency_hz, double target_hz) { return 1200 * std::log2(frequency_hz / target_hz); }

// Bakes the band that the targets lie in, and finds the targets' modes.
class TargetBakes {
 public:
  TargetBakes(const TuneRequest& request, const modal::Material& material)
      : recipe(request.recipe), request_(request), material_(material) {
    const auto [low, high] =
        std::minmax_element(request.targets.begin(), request.targets.end(),
                            [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
    recipe.options.band_low_hz = kBandBelow * low->frequency_hz;
    recipe.options.band_high_hz = kBandAbove * high->frequency_hz;
    recipe.options.keep_modes = 0;
    recipe.options.floor_db = 0;
    recipe.options.air.reset();
    recipe.options.resonators.clear();
    recipe.options.cavity.reset();
    if (recipe.options.liquids.fill) recipe.options.liquids.fill->levels = 0;
    recipe.error = 0;
  }

  Result<modal::Bank> bake() {
    Result<BakedObject> object = bake_recipe(recipe, material_, [this](std::string_view stage, double fraction) {
      stopped_ = stopped_ || (request_.progress && !request_.progress(stage, fraction));
      return !stopped_;
    });
    ++count_;
    if (!object) return fail(object);
    return std::move(object->baked.bank);
  }

  [[nodiscard]] Result<std::vector<FoundMode>> found_in(const modal::Bank& bank) const {
    const BodyAxes axes = body_axes(bank, request_.strike);
    std::map<ModeFamily, std::vector<std::size_t>> families;
    std::vector<FoundMode> found;
    for (const TuneTarget& target : request_.targets) {
      if (!families.contains(target.family)) families[target.family] = modes_of(bank, axes, target.family);
      const std::vector<std::size_t>& modes = families[target.family];
      if (modes.size() < static_cast<std::size_t>(target.mode))
        return fail(ErrorKind::bad_input, too_few(target, modes.size()));
      const std::size_t mode = modes[target.mode - 1];
      const double error = bank.frequency_error.empty() ? 0 : bank.frequency_error[mode];
      found.push_back({.frequency_hz = bank.frequency_hz[mode],
                       .cents = cents_between(bank.frequency_hz[mode], target.frequency_hz),
                       .error_cents = cents_between(1 + error, 1)});
    }
    return found;
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool stopped() const { return stopped_; }

  ObjectRecipe recipe;  // of the next bake

 private:
  [[nodiscard]] std::string too_few(const TuneTarget& target, std::size_t there) const {
    return formatted(
        "{} has {} modes of the family '{}' between {:.0f} and {:.0f} Hz, but mode {} has a target; start nearer to "
        "the targets",
        recipe.name, there, family_name(target.family), recipe.options.band_low_hz, recipe.options.band_high_hz,
        target.mode);
  }

  const TuneRequest& request_;
  const modal::Material& material_;
  int count_ = 0;
  bool stopped_ = false;
};

VectorXd cents_of(const std::vector<FoundMode>& found) {
  VectorXd cents(static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) cents[static_cast<Eigen::Index>(i)] = found[i].cents;
  return cents;
}

class ObjectTuner {
 public:
  ObjectTuner(const TuneRequest& request, const modal::Material& material)
      : request_(request), bakes_(request, material), variables_(request.variables) {
    best_.slopes = request.slopes;
  }

  Result<TunedObject> run() {
    const fem::Element own = bakes_.recipe.options.element;
    if (fem::order_of(own) > 2 && best_.slopes.size() == 0) {
      set_element(fem::Element::kTet10);
      auto done = round("coarse", std::max(kCoarseTolerance_cents, request_.tolerance_cents), kMaxCoarseBakes);
      if (!done && (bakes_.stopped() || bakes_.count() == 1)) return fail(done);
    }
    set_element(own);
    Result<void> done = round("fine", request_.tolerance_cents, kMaxBakes);
    double& mesh_size_m = bakes_.recipe.meshing.mesh_size_m;
    for (int finer = 0; done && worst_error() >= kMaxErrorCents && finer < kMaxRefinements; ++finer) {
      mesh_size_m = to_digits(kRefinement * mesh_size_m, 6);
      done = round("finer", request_.tolerance_cents, kMaxBakes);
    }
    if (!done) return fail(done);
    TunedObject tuned{.found = found_, .mesh_size_m = mesh_size_m, .bakes = bakes_.count()};
    for (const TuneVariable& variable : variables_) tuned.parameters[variable.name] = to_digits(variable.start, 6);
    tuned.slopes = best_.slopes;
    tuned.reached = best_.reached && worst_error() < kMaxErrorCents;
    return tuned;
  }

 private:
  void set_element(fem::Element element) {
    bakes_.recipe.options.element = element;
    bakes_.recipe.meshing.order = fem::order_of(element);
  }

  [[nodiscard]] double worst_error() const {
    double worst = 0;
    for (const FoundMode& mode : found_) worst = std::max(worst, mode.error_cents);
    return worst;
  }

  // Leaves the best parameters as the variables' start, and what they give in found_.
  Result<void> round(std::string_view stage, double tolerance_cents, int max_bakes) {
    stage_ = stage;
    best_cents_ = -1;
    TuneOptions options{.tolerance_cents = tolerance_cents, .max_evaluations = max_bakes, .slopes = best_.slopes};
    options.stopped = [this] { return bakes_.stopped(); };
    Result<Tuned> tuned = tune(
        variables_, [this](const VectorXd& at) { return evaluate(at); }, options);
    if (!tuned) return fail(tuned);
    best_ = std::move(*tuned);
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      variables_[i].start = best_.parameters[static_cast<Eigen::Index>(i)];
    }
    return {};
  }

  Result<VectorXd> evaluate(const VectorXd& at) {
    std::map<std::string, double> parameters;
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      parameters[variables_[i].name] = to_digits(at[static_cast<Eigen::Index>(i)], 6);
    }
    for (const auto& [name, value] : parameters) bakes_.recipe.meshing.parameters[name] = value;
    const Result<modal::Bank> bank = bakes_.bake();
    if (!bank) return fail(bank);
    const Result<std::vector<FoundMode>> found = bakes_.found_in(*bank);
    if (!found) return fail(found);
    const VectorXd cents = cents_of(*found);
    if (best_cents_ < 0 || cents.norm() < best_cents_) {
      best_cents_ = cents.norm();
      found_ = *found;
    }
    if (request_.told) request_.told({bakes_.count(), stage_, parameters, *found});
    return cents;
  }

  const TuneRequest& request_;
  TargetBakes bakes_;
  std::vector<TuneVariable> variables_;
  std::string_view stage_;
  Tuned best_;
  std::vector<FoundMode> found_;
  double best_cents_ = -1;
};

// One bake, at the highest level and with a coarse wall of the liquid, keeps what the modes of other levels need, so
// that the search takes no bakes. A bake at the level found confirms it; what that bake is off by is added in the next
// search.
class LevelTuner {
 public:
  LevelTuner(const TuneRequest& request, const modal::Material& material)
      : request_(request), bakes_(request, material), variable_(request.variables.front()), levels_(request.levels) {
    bakes_.recipe.options.band_low_hz = request.recipe.options.band_low_hz;
    bakes_.recipe.options.band_high_hz = request.recipe.options.band_high_hz;
  }

  Result<TunedObject> run() {
    if (!levels_) {
      if (auto baked = bake_levels(); !baked) return fail(baked);
    }
    for (const double end : {variable_.low, variable_.high}) {
      if (auto good = modal::check_level(*levels_, at_scale(end)); !good) return fail(bakes_.recipe.name, good);
    }
    TunedObject best{.mesh_size_m = request_.recipe.meshing.mesh_size_m, .levels = levels_};
    VectorXd off = VectorXd::Zero(static_cast<Eigen::Index>(request_.targets.size()));
    for (int turn = 0; turn < kMaxLevelBakes && !best.reached; ++turn) {
      const Result<Tuned> tuned = search(off);
      if (!tuned) return fail(tuned);
      variable_.start = to_digits(tuned->parameters[0], 6);
      const Result<std::vector<FoundMode>> found = confirm(variable_.start);
      if (!found) return fail(found);
      const VectorXd cents = cents_of(*found);
      if (turn == 0 || cents.norm() < cents_of(best.found).norm()) {
        best.found = *found;
        best.parameters[variable_.name] = variable_.start;
      }
      best.reached = cents.cwiseAbs().maxCoeff() <= request_.tolerance_cents;
      if (!tuned->reached) break;
      const Result<VectorXd> searched = cents_at(variable_.start);
      if (!searched) return fail(searched);
      off = cents - *searched;
    }
    best.bakes = bakes_.count();
    return best;
  }

 private:
  [[nodiscard]] double at_scale(double level_m) const { return bakes_.recipe.scale * level_m; }

  Result<modal::Bank> bake_at(double level_m, std::size_t levels, int wall_nodes) {
    Filling& filling = *bakes_.recipe.options.liquids.fill;
    filling.amount = {liquid::Amount::Kind::kLevel, level_m};
    filling.levels = levels;
    filling.wall_nodes = wall_nodes;
    return bakes_.bake();
  }

  Result<void> bake_levels() {
    const std::size_t stated = request_.recipe.options.liquids.fill->levels;
    Result<modal::Bank> bank = bake_at(variable_.high, stated > 0 ? stated : kSearchedLevels, kSearchedNodes);
    if (!bank) return fail(bank);
    levels_ = std::make_shared<const modal::Bank>(std::move(*bank));
    return {};
  }

  [[nodiscard]] Result<VectorXd> cents_at(double level_m) const {
    const Result<modal::LevelBank> there = modal::at_level(*levels_, at_scale(level_m));
    if (!there) return fail(there);
    const Result<std::vector<FoundMode>> found = bakes_.found_in(there->bank);
    if (!found) return fail(found);
    return cents_of(*found);
  }

  [[nodiscard]] Result<Tuned> search(const VectorXd& off) const {
    const TuneOptions options{.tolerance_cents = kSearchTolerance * request_.tolerance_cents};
    return tune(
        {variable_},
        [&](const VectorXd& at) -> Result<VectorXd> {
          const Result<VectorXd> cents = cents_at(at[0]);
          if (!cents) return fail(cents);
          return *cents + off;
        },
        options);
  }

  Result<std::vector<FoundMode>> confirm(double level_m) {
    const Result<modal::Bank> bank = bake_at(level_m, 0, liquid::kWetNodes);
    if (!bank) return fail(bank);
    Result<std::vector<FoundMode>> found = bakes_.found_in(*bank);
    if (found && request_.told) request_.told({bakes_.count(), "level", {{variable_.name, level_m}}, *found});
    return found;
  }

  const TuneRequest& request_;
  TargetBakes bakes_;
  TuneVariable variable_;
  std::shared_ptr<const modal::Bank> levels_;
};

// Fails when the level is varied together with something else, or when the object has none that can be.
Result<void> check_level_request(const TuneRequest& request) {
  const Liquids& liquids = request.recipe.options.liquids;
  const std::string name = request.recipe.name + ": ";
  if (request.variables.size() > 1)
    return fail(ErrorKind::bad_input, name + "fill.level is varied alone; tune the geometry first, then the level");
  if (!liquids.fill)
    return fail(ErrorKind::bad_input, name + "it has no [fill] whose level could be varied; add one to its file");
  if (liquids.bath)
    return fail(ErrorKind::bad_input,
                name + "the level is not varied in a body that stands in a bath; leave out [bath]");
  return {};
}

}  // namespace

bool TuneRequest::varies_level() const {
  return std::ranges::any_of(variables, [](const TuneVariable& variable) { return variable.name == kLevelVariable; });
}

Result<TunedObject> tune_object(const TuneRequest& request, const std::filesystem::path& materials) {
  if (request.varies_level()) {
    if (auto good = check_level_request(request); !good) return fail(good);
  } else if (!(request.recipe.meshing.mesh_size_m > 0)) {
    return fail(ErrorKind::bad_input,
                request.recipe.name + " states no mesh size; give it mesh_size_m, so that all bakes use the same");
  }
  const Result<MaterialEntry> material = find_material(materials, request.recipe.material);
  if (!material) return fail(material);
  Result<ObjectRecipe> whole = with_part_materials(request.recipe, materials);
  if (!whole) return fail(whole);
  TuneRequest complete = request;
  complete.recipe = std::move(*whole);
  if (request.varies_level()) return LevelTuner(complete, material->material).run();
  return ObjectTuner(complete, material->material).run();
}

}  // namespace ringdown::bake
