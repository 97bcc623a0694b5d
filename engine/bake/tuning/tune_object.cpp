#include "engine/bake/tuning/tune_object.h"

#include "engine/bake/bake_object.h"
#include "engine/base/range.h"
#include "engine/materials/material_library.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::VectorXd;

constexpr double kBandAbove = 1.8, kBandBelow = 0.3;  // of the highest and the lowest target
constexpr double kCoarseTolerance_cents = 3;
constexpr int kMaxCoarseBakes = 25, kMaxBakes = 60;
constexpr double kRefinement = 0.7;  // of the mesh size, from round to round

double cents_between(double frequency_hz, double target_hz) { return 1200 * std::log2(frequency_hz / target_hz); }

class ObjectTuner {
 public:
  ObjectTuner(const TuneRequest& request, const modal::Material& material)
      : request_(request), material_(material), recipe_(request.recipe), variables_(request.variables) {
    const auto [low, high] =
        std::minmax_element(request.targets.begin(), request.targets.end(),
                            [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
    recipe_.options.band_low_hz = kBandBelow * low->frequency_hz;
    recipe_.options.band_high_hz = kBandAbove * high->frequency_hz;
    recipe_.options.keep_modes = 0;
    recipe_.options.floor_db = 0;
    recipe_.options.air.reset();
    recipe_.options.resonators.clear();
    recipe_.error = 0;
    best_.slopes = request.slopes;
  }

  Result<TunedObject> run() {
    const fem::Element own = recipe_.options.element;
    if (fem::order_of(own) > 2 && best_.slopes.size() == 0) {
      set_element(fem::Element::kTet10);
      auto done = round("coarse", std::max(kCoarseTolerance_cents, request_.tolerance_cents), kMaxCoarseBakes);
      if (!done && (stopped_ || bakes_ == 1)) return fail(done);
    }
    set_element(own);
    Result<void> done = round("fine", request_.tolerance_cents, kMaxBakes);
    for (int finer = 0; done && worst_error() >= kMaxErrorCents && finer < kMaxRefinements; ++finer) {
      recipe_.meshing.mesh_size_m = to_digits(kRefinement * recipe_.meshing.mesh_size_m, 6);
      done = round("finer", request_.tolerance_cents, kMaxBakes);
    }
    if (!done) return fail(done);
    TunedObject tuned{.found = found_, .mesh_size_m = recipe_.meshing.mesh_size_m, .bakes = bakes_};
    for (const TuneVariable& variable : variables_) tuned.parameters[variable.name] = to_digits(variable.start, 6);
    tuned.slopes = best_.slopes;
    tuned.reached = best_.reached && worst_error() < kMaxErrorCents;
    return tuned;
  }

 private:
  void set_element(fem::Element element) {
    recipe_.options.element = element;
    recipe_.meshing.order = fem::order_of(element);
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
    options.stopped = [this] { return stopped_; };
    const CentsOf cents_of = [this](const VectorXd& at) { return evaluate(at); };
    Result<Tuned> tuned = tune(variables_, cents_of, options);
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
    for (const auto& [name, value] : parameters) recipe_.meshing.parameters[name] = value;
    const Result<BakedObject> object = bake_recipe(recipe_, material_, [this](std::string_view stage, double fraction) {
      stopped_ = stopped_ || (request_.progress && !request_.progress(stage, fraction));
      return !stopped_;
    });
    ++bakes_;
    if (!object) return fail(object);
    const Result<std::vector<FoundMode>> found = find_targets(object->baked.bank);
    if (!found) return fail(found);
    VectorXd cents(static_cast<Eigen::Index>(found->size()));
    for (std::size_t i = 0; i < found->size(); ++i) cents[static_cast<Eigen::Index>(i)] = (*found)[i].cents;
    if (best_cents_ < 0 || cents.norm() < best_cents_) {
      best_cents_ = cents.norm();
      found_ = *found;
    }
    if (request_.told) request_.told({bakes_, stage_, parameters, *found});
    return cents;
  }

  [[nodiscard]] Result<std::vector<FoundMode>> find_targets(const modal::Bank& bank) const {
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

  [[nodiscard]] std::string too_few(const TuneTarget& target, std::size_t there) const {
    return formatted(
        "{} has {} modes of the family '{}' between {:.0f} and {:.0f} Hz, but mode {} has a target; start nearer to "
        "the targets",
        recipe_.name, there, family_name(target.family), recipe_.options.band_low_hz, recipe_.options.band_high_hz,
        target.mode);
  }

  const TuneRequest& request_;
  const modal::Material& material_;
  ObjectRecipe recipe_;
  std::vector<TuneVariable> variables_;
  std::string_view stage_;
  Tuned best_;
  std::vector<FoundMode> found_;
  double best_cents_ = -1;
  int bakes_ = 0;
  bool stopped_ = false;
};

}  // namespace

Result<TunedObject> tune_object(const TuneRequest& request, const std::filesystem::path& materials) {
  if (!(request.recipe.meshing.mesh_size_m > 0)) {
    return fail(ErrorKind::bad_input,
                request.recipe.name + " states no mesh size; give it mesh_size_m, so that all bakes use the same");
  }
  const Result<MaterialEntry> material = find_material(materials, request.recipe.material);
  if (!material) return fail(material);
  Result<ObjectRecipe> whole = with_part_materials(request.recipe, materials);
  if (!whole) return fail(whole);
  TuneRequest complete = request;
  complete.recipe = std::move(*whole);
  return ObjectTuner(complete, material->material).run();
}

}  // namespace ringdown::bake
