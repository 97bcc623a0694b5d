#include "engine/bake/bake_object.h"

#include "engine/bake/fitted_makeup.h"
#include "engine/base/atomic_file.h"
#include "engine/base/content_cache.h"
#include "engine/base/free_memory.h"
#include "engine/base/range.h"
#include "engine/materials/material_library.h"
#include "engine/mesh/body_reader.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

// Rounds until the error holds
//
// plan() chooses what the recipe leaves open. Then rounds follow each other: mesh, bake, compare the estimated error of
// the worst mode with the one asked for. The error of order p falls as the 2p-th power of the elements' size, which
// says how much finer the next mesh should be; the step is bounded below and above, because the estimate is only an
// estimate. When the next mesh would have too many unknowns, raising the order comes instead, which gains more for
// less.
namespace ringdown::bake {
namespace {

constexpr std::size_t kMaxGeometry = 16 << 20;                            // bytes hashed for a family's name
constexpr double kMinStepSize = 0.4, kMaxStepSize = 0.85, kMargin = 0.9;  // of mesh sizes from round to round
constexpr double kSmallAtBends = 0.6;  // of the chosen size: the mean of elements' longest edges
constexpr double kPreviewUnknowns = 5000, kMaxPreviewUnknowns = 50e3, kPreviewShapeError = 0.1;
constexpr Eigen::Index kPreviewElements = 10'000;  // of a mesh from a file, that order 2 is still quick with

// Meshes of one geometry with the same parameters, however fine and of whatever material.
std::string family_of(const ObjectRecipe& recipe) {
  const Result<std::string> geometry = read_whole_file(recipe.geometry, kMaxGeometry);
  if (!geometry) return "";
  ContentHasher hasher;
  hasher.text(*geometry);
  for (const auto& [name, value] : recipe.meshing.parameters) hasher.text(name).value(value);
  if (recipe.meshing.wall_scale != 1) hasher.text("wall").value(recipe.meshing.wall_scale);
  for (const std::filesystem::path& part : part_surfaces(recipe)) {
    const Result<std::string> surface = read_whole_file(part, kMaxGeometry);
    if (!surface) return "";
    hasher.text(*surface);
  }
  return hasher.hash().text();
}

// The slowest of the body's materials, alike in all directions: its waves are the shortest. For plans.
modal::Material slowest_stand_in(const Makeup& makeup, const modal::Material& material) {
  const auto alike = [](const modal::Material& one, const std::optional<Grain>& grain) {
    return grain ? isotropic_stand_in(one) : one;
  };
  const auto speed = [](const modal::Material& one) { return one.youngs_modulus_pa / one.density_kg_m3; };
  modal::Material slowest = alike(material, makeup.grain);
  for (const Part& part : makeup.parts) {
    modal::Material own = alike(part.material, part.grain);
    if (speed(own) < speed(slowest)) slowest = std::move(own);
  }
  return slowest;
}

double mean_longest_edge(const mesh::TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::Corners corners = mesh::corners_of(mesh, e);
    double longest = 0;
    for (const auto& [a, b] : mesh::kTetEdges) longest = std::max(longest, (corners.row(b) - corners.row(a)).norm());
    sum += longest;
  }
  return sum / static_cast<double>(mesh.elements.rows());
}

fem::Element of_order(int order) {
  constexpr std::array kElements = {fem::Element::kTet4, fem::Element::kTet10, fem::Element::kTet20,
                                    fem::Element::kTet35};
  return kElements[order - 1];
}

// About how many times the unknowns of order p those of p + 1 are.
double growth(int order) {
  constexpr std::array kGrowth = {8.0, 2.8, 2.3};
  return kGrowth[order - 1];
}

class Baker {
 public:
  Baker(const ObjectRecipe& recipe, const modal::Material& material, const Progress& progress)
      : recipe_(recipe),
        material_(material),
        stand_in_(slowest_stand_in(recipe.options.makeup, material)),
        progress_(progress),
        reader_(recipe.geometry, recipe.options.cache) {
    if (!recipe.options.cache.empty()) recipe_.options.family = family_of(recipe);
    if (recipe.error > 0) recipe_.options.radiation_error = recipe.error;
    if (recipe.preview) recipe_.options.air.reset(), recipe_.options.resonators.clear(), recipe_.options.cavity.reset();
    recipe_.options.makeup = scaled(std::move(recipe_.options.makeup), recipe.scale);
    recipe_.options.liquids = recipe_.options.liquids.scaled(recipe.scale);
    for (Resonator& resonator : recipe_.options.resonators) resonator = resonator.scaled(recipe.scale);
    if (recipe_.options.cavity) recipe_.options.cavity = recipe_.options.cavity->scaled(recipe.scale);
    if (recipe.shatter) recipe_.options.interior = true;
  }

  Result<Forecast> forecast() {
    if (auto planned = plan(); !planned) return fail(planned);
    if (auto meshed = mesh(); !meshed) return fail(meshed);
    const BakeCost cost = this->cost();
    BakedObject object = finished();
    return Forecast{.choice = object.choice,
                    .mesh = std::move(object.mesh),
                    .making = object.making,
                    .notes = std::move(object.notes),
                    .element = recipe_.options.element,
                    .cost = cost,
                    .mesh_processor_s = reader_.processor_s()};
  }

  Result<BakedObject> run() {
    if (auto possible = check_shatter(); !possible) return fail(possible);
    if (auto planned = plan(); !planned) return fail(planned);
    bool same_mesh = false;
    for (;;) {
      if (!same_mesh) {
        if (auto meshed = mesh(); !meshed) return fail(meshed);
      }
      if (auto fits = check_memory(cost(), free_memory_bytes(), recipe_.name); !fits)
        return fail(with_question(fits.error()));
      if (auto baked = bake_once(); !baked) return fail(baked);
      if (recipe_.error <= 0 || error() <= recipe_.error) {
        if (auto compared = compare_nonlinear(); !compared) return fail(compared);
        if (auto broken = shatter(); !broken) return fail(broken);
        return finished();
      }
      const Result<bool> refined = refine();
      if (!refined) return fail(refined);
      same_mesh = *refined;
    }
  }

 private:
  // The baked object, its mesh and lengths scaled to the size of the object.
  BakedObject finished() {
    object_.mesh.mesh.nodes *= recipe_.scale;
    if (object_.choice) {
      for (double* length : {&object_.choice->size_m, &object_.choice->edge_size_m, &object_.choice->shortest_wave_m,
                             &object_.choice->wall_m}) {
        *length *= recipe_.scale;
      }
    }
    return std::move(object_);
  }

  [[nodiscard]] BakeCost cost() const {
    const mesh::TetMesh sized{object_.mesh.mesh.nodes * recipe_.scale, object_.mesh.mesh.elements};
    return expected_cost(sized, recipe_.options.element, stand_in_, recipe_.options.band_high_hz);
  }

  [[nodiscard]] double error() const { return object_.rounds.back().error; }

  bool go_on(std::string_view stage, double fraction) const {
    if (!progress_) return true;
    if (object_.rounds.empty()) return progress_(stage, fraction);
    const std::string prefix = formatted("round {}, error {} so far: ", object_.rounds.size() + 1, as_percent(error()));
    return progress_(prefix + std::string(stage), fraction);
  }

  [[nodiscard]] Progress progress() const {
    return [this](std::string_view stage, double fraction) { return go_on(stage, fraction); };
  }

  void set_order(int order) {
    recipe_.options.element = of_order(order);
    recipe_.meshing.order = order;
  }

  // The mesh size, where none is named, and what a preview leaves out.
  Result<void> plan() {
    if (recipe_.preview) {
      set_order(2);
      recipe_.meshing.quick = true;
      recipe_.options.shape_error = std::max(recipe_.options.shape_error, kPreviewShapeError);
    }
    const bool named = recipe_.meshing.mesh_size_m > 0;
    if (!reader_.meshes()) return {};
    if (named && !recipe_.preview) return reader_.is_surface() ? check_named_size() : Result<void>();
    if (!go_on("mesh", 0)) return fail_cancelled();
    const Result<mesh::Sketch> sketch = reader_.sketch(recipe_.meshing, progress());
    if (!sketch) return fail(sketch);
    if (sketch->sized_by_file && !recipe_.preview) return {};
    if (take_size_from_parameters() && !recipe_.preview) return {};
    const BodyShape shape = measure_shape(sketch->skin, sketch->wall_m);
    const int order = fem::order_of(recipe_.options.element);
    // Frequencies fall with size: the band of a larger object is `scale` times as wide for its unscaled geometry.
    const double band_high_hz = std::max(recipe_.scale, 1.0) * recipe_.options.band_high_hz;
    MeshChoice choice = choose_mesh(shape, stand_in_, band_high_hz, order, kMaxChosenUnknowns);
    if (recipe_.preview) {
      const MeshChoice quick = choose_coarse_mesh(shape, order, kPreviewUnknowns);
      if (quick.size_m > choice.size_m) choice = quick;
    }
    recipe_.meshing.mesh_size_m = choice.size_m;
    recipe_.meshing.edge_size_m = choice.edge_size_m;
    object_.choice = choice;
    return {};
  }

  // A value of mesh_size that the recipe sets, and the .geo file does not use, is the longest edge all the same.
  bool take_size_from_parameters() {
    const auto set = recipe_.meshing.parameters.find(mesh::kMeshSizeName);
    if (set == recipe_.meshing.parameters.end() || !(set->second > 0)) return false;
    const double unit_m = recipe_.meshing.unit_m.value_or(mesh::unit_in_file(recipe_.geometry));
    recipe_.meshing.mesh_size_m = unit_m * set->second;
    return true;
  }

  // A size for which not even a multiple of the memory would do is refused before the surface is meshed. Where it means
  // more elements than anybody meshes, or the surface encloses nothing (and no number can be told), the reader refuses.
  Result<void> check_named_size() {
    constexpr double kTimes = 3, kMaxUnknowns = 1e8;  // the number of unknowns is only a guess so far
    const Result<const mesh::PreparedSurface*> surface = reader_.surface(recipe_.meshing, progress());
    if (!surface) return fail(surface);
    mesh::TriangleMesh sized = (*surface)->mesh;
    const BakeCost cost = expected_cost(measure_shape(sized, 0), recipe_.meshing.mesh_size_m, recipe_.options.element,
                                        stand_in_, recipe_.options.band_high_hz);
    const double free_bytes = free_memory_bytes();
    if (!(cost.memory_bytes > kTimes * free_bytes) || cost.unknowns > kMaxUnknowns) return {};
    sized.nodes *= recipe_.scale;
    ask_about_size(measure_shape(sized, 0));
    const Result<void> fits = check_memory(cost, free_bytes, recipe_.name);
    return fits ? fits : fail(with_question(fits.error()));
  }

  void ask_about_size(const BodyShape& shape) {
    object_.question =
        question_size(shape, stand_in_, recipe_.options.band_high_hz, recipe_.options.max_modes, recipe_.geometry,
                      recipe_.meshing.unit_m.value_or(mesh::unit_in_file(recipe_.geometry)));
  }

  // Meshes. Where a chosen size made far more unknowns than it should, one of two things helps. Elements that are small
  // because the surface bends, not because of the waves, would stay so, and lower order does for the waves. Otherwise
  // the body is meshed once more with a larger size.
  Result<void> mesh() {
    if (auto meshed = mesh_once(); !meshed) return meshed;
    const bool sized_here = reader_.is_surface() && object_.choice && object_.making == mesh::Making::kFilled;
    const double max = recipe_.preview ? kMaxPreviewUnknowns : 1.5 * kMaxChosenUnknowns;
    const double unknowns = sized_here ? cost().unknowns : 0;
    if (unknowns <= max) return {};
    const int order = fem::order_of(recipe_.options.element);
    const bool bends = mean_longest_edge(object_.mesh.mesh) < kSmallAtBends * recipe_.meshing.mesh_size_m;
    if (bends && order > 2 && unknowns <= growth(order - 1) * max) {
      set_order(order - 1);
      return {};
    }
    recipe_.meshing.mesh_size_m *= std::sqrt(unknowns / max);
    object_.choice->size_m = recipe_.meshing.mesh_size_m;
    return mesh_once();
  }

  Result<void> mesh_once() {
    if (!go_on("mesh", 0)) return fail_cancelled();
    const auto start = std::chrono::steady_clock::now();
    Result<mesh::Body> body = reader_.read(recipe_.meshing, progress());
    if (!body) return fail(body);
    object_.mesh = std::move(body->mesh);
    const mesh::TetMesh sized{object_.mesh.mesh.nodes * recipe_.scale, object_.mesh.mesh.elements};
    ask_about_size(measure_shape(sized));
    object_.making = body->making;
    object_.notes = std::move(body->notes);
    object_.mesh_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    object_.wall_elements = body->wall_elements;
    // Stuffing follows walls with many small straight elements: too many for a high order.
    if (object_.making == mesh::Making::kStuffed && fem::order_of(recipe_.options.element) > 2) set_order(2);
    const bool large = object_.mesh.mesh.elements.rows() > kPreviewElements;
    if (recipe_.preview && !reader_.meshes() && large) set_order(1);
    return {};
  }

  Result<void> bake_once() {
    mesh::CheckedMesh scaled = object_.mesh;
    scaled.mesh.nodes *= recipe_.scale;
    scaled.gaps_m *= recipe_.scale;
    Result<Baked> baked = bake(scaled, material_, recipe_.options, recipe_.name, progress());
    if (!baked) return fail(with_question(baked.error()));
    object_.baked = std::move(*baked);
    object_.baked.bank.provenance.body = mesh::text_of(object_.making);
    object_.baked.bank.provenance.wall_elements = object_.wall_elements;
    object_.rounds.push_back({.element = recipe_.options.element,
                              .elements = object_.baked.report.elements,
                              .unknowns = object_.baked.report.unknowns,
                              .error = object_.baked.report.largest_error});
    return {};
  }

  [[nodiscard]] Result<void> check_shatter() const {
    if (!recipe_.shatter) return {};
    const char* const what = !recipe_.options.makeup.moves_freely() ? "a grain, parts, masses or stiff supports"
                             : recipe_.options.nonlinear > 0        ? "nonlinear modes"
                             : !recipe_.options.liquids.none()      ? "a liquid"
                             : !recipe_.options.resonators.empty()  ? "a resonator"
                             : recipe_.options.cavity               ? "a [cavity]"
                                                                    : nullptr;
    if (what == nullptr) return {};
    return fail(ErrorKind::bad_input,
                "{}: a body with {} cannot be broken; leave [shatter] out, or make it of one free material",
                recipe_.name, what);
  }

  // Breaks the body, if its recipe says so.
  Result<void> shatter() {
    if (!recipe_.shatter) return {};
    Shatter how = *recipe_.shatter;
    for (Vec3& place : how.places_m) place = recipe_.scale * place;
    Result<modal::Fracture> fracture = shatter_body(object_.baked, how, recipe_.options, progress());
    if (!fracture) return fail(fracture);
    for (modal::BreakPattern& pattern : fracture->patterns) {
      for (modal::PieceBank& piece : pattern.pieces) piece.bank.gain = std::pow(10.0, recipe_.gain_db / 20);
    }
    object_.baked.bank.fracture = std::make_shared<const modal::Fracture>(std::move(*fracture));
    return {};
  }

  // Estimates the errors of nonlinear terms: how far a coarser mesh of the same geometry is from them. Leaves them
  // unknown where no coarser mesh can be made.
  Result<void> compare_nonlinear() {
    constexpr double kCoarser = 1.4, kMaxElementShare = 0.85, kBandMargin = 1.1;
    modal::Bank& bank = object_.baked.bank;
    if (!bank.nonlinear || !reader_.meshes() || recipe_.preview) return {};
    mesh::GmshOptions meshing = recipe_.meshing;
    const double size_m = meshing.mesh_size_m > 0 ? meshing.mesh_size_m : mean_longest_edge(object_.mesh.mesh);
    meshing.mesh_size_m = kCoarser * size_m;
    meshing.edge_size_m *= kCoarser;
    Result<mesh::Body> body = reader_.read(meshing, progress());
    if (!body || static_cast<double>(body->mesh.mesh.elements.rows()) >
                     kMaxElementShare * static_cast<double>(object_.mesh.mesh.elements.rows())) {
      return {};
    }
    body->mesh.mesh.nodes *= recipe_.scale;
    BakeOptions options = recipe_.options;
    options.air.reset();
    options.shape_error = kPreviewShapeError;
    double highest_hz = 0;
    for (const std::uint32_t mode : bank.nonlinear->modes) highest_hz = std::max(highest_hz, bank.frequency_hz[mode]);
    options.band_high_hz = std::min(options.band_high_hz, kBandMargin * highest_hz);
    const Result<Baked> coarse = bake(body->mesh, material_, options, recipe_.name, progress());
    if (!coarse) return coarse.error().kind == ErrorKind::cancelled ? fail(coarse) : Result<void>();
    const BakeReport &fine = object_.baked.report, &other = coarse->report;
    if (other.hardening.size() < fine.hardening.size()) return {};
    for (const std::size_t mode : fine.hardened)
      bank.nonlinear->errors.push_back(std::abs(other.hardening[mode] / fine.hardening[mode] - 1));
    return {};
  }

  // Prepares the next round; true when it takes object_.mesh as it is.
  Result<bool> refine() {
    if (object_.rounds.size() >= kMaxRounds) return fail(ErrorKind::too_large, out_of_reach("this was the last round"));
    return reader_.meshes() ? refine_geometry() : refine_mesh();
  }

  Result<bool> refine_geometry() {
    const int order = fem::order_of(recipe_.options.element);
    const double wanted = kMargin * std::pow(recipe_.error / error(), 0.5 / order);
    const BodyShape shape = measure_shape(object_.mesh.mesh);
    const double edge = mean_longest_edge(object_.mesh.mesh);
    const double now = recipe_.meshing.mesh_size_m > 0 ? std::min(recipe_.meshing.mesh_size_m, edge) : edge;
    const auto unknowns_at = [&](double step) {
      return unknowns() * estimated_unknowns(shape, step * now, order) / estimated_unknowns(shape, now, order);
    };
    const double step = std::clamp(wanted, kMinStepSize, kMaxStepSize);
    const bool too_many = unknowns_at(std::min(wanted, kMaxStepSize)) > recipe_.max_unknowns;
    if (too_many && order < mesh::kMaxOrder && unknowns() * growth(order) <= recipe_.max_unknowns) {
      set_order(order + 1);
      return false;
    }
    if (unknowns_at(step) > recipe_.max_unknowns)
      return fail(ErrorKind::too_large, out_of_reach(more_than_most(unknowns_at(step))));
    recipe_.meshing.mesh_size_m = step * now;
    recipe_.meshing.edge_size_m *= step;
    return false;
  }

  // A mesh from a file cannot be made anew: its order is raised, and at the highest order each element is split in
  // eight.
  Result<bool> refine_mesh() {
    const int order = fem::order_of(recipe_.options.element);
    const bool raise = order < mesh::kMaxOrder;
    const double next = unknowns() * (raise ? growth(order) : 8);
    if (next > recipe_.max_unknowns) return fail(ErrorKind::too_large, out_of_reach(more_than_most(next)));
    if (raise) {
      set_order(order + 1);
    } else {
      if (!object_.mesh.groups.empty() && !recipe_.options.makeup.plain())
        return fail(ErrorKind::too_large, out_of_reach("a mesh with groups cannot be split"));
      Result<mesh::CheckedMesh> fine = mesh::check_mesh(mesh::split(object_.mesh.mesh), recipe_.geometry.string());
      if (!fine) return fail(fine);
      object_.mesh = std::move(*fine);
    }
    return true;
  }

  [[nodiscard]] Error with_question(Error error) const {
    const bool cancelled = error.kind == ErrorKind::cancelled;
    if (!cancelled && !object_.question.empty()) error.message += "; " + object_.question;
    return error;
  }

  [[nodiscard]] double unknowns() const { return static_cast<double>(object_.rounds.back().unknowns); }

  [[nodiscard]] std::string more_than_most(double wanted) const {
    return formatted("the next round would take about {:.2g} million unknowns, more than {:.2g}", wanted / 1e6,
                     recipe_.max_unknowns / 1e6);
  }

  [[nodiscard]] std::string out_of_reach(const std::string& why) const {
    const double best =
        std::min_element(object_.rounds.begin(), object_.rounds.end(), [](const Round& a, const Round& b) {
          return a.error < b.error;
        })->error;
    return formatted(
        "{}: the error stays at {} instead of {} ({}); allow a larger --error, or narrow the band with --band",
        recipe_.name, as_percent(best), as_percent(recipe_.error), why);
  }

  ObjectRecipe recipe_;
  const modal::Material& material_;
  const modal::Material stand_in_;  // for plans
  const Progress& progress_;
  mesh::BodyReader reader_;
  BakedObject object_;
};

}  // namespace

Result<Forecast> forecast(const ObjectRecipe& recipe, const modal::Material& material, const Progress& progress) {
  return Baker(recipe, material, progress).forecast();
}

Result<BakedObject> bake_recipe(const ObjectRecipe& recipe, const modal::Material& material, const Progress& progress) {
  return Baker(recipe, material, progress).run();
}

namespace {

// Looks the liquids up in `liquids` beside the folder of materials.
Result<void> find_liquids(const std::filesystem::path& materials, Liquids& liquids) {
  const std::filesystem::path folder = liquid_folder(materials);
  const auto find = [&](liquid::Liquid& liquid) -> Result<void> {
    Result<liquid::Liquid> found = liquid::find_liquid(folder, liquid.name);
    if (!found) return fail(found);
    liquid = std::move(*found);
    return {};
  };
  if (liquids.fill) {
    if (auto found = find(liquids.fill->liquid); !found) return found;
  }
  return liquids.bath ? find(liquids.bath->liquid) : Result<void>();
}

}  // namespace

Result<ObjectRecipe> with_part_materials(ObjectRecipe recipe, const std::filesystem::path& materials) {
  for (Part& part : recipe.options.makeup.parts) {
    Result<MaterialEntry> material = find_material(materials, part.material.name);
    if (!material) return fail(material);
    part.material = std::move(material->material);
  }
  if (auto found = find_liquids(materials, recipe.options.liquids); !found) return fail(found);
  return recipe;
}

Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress) {
  Result<MaterialEntry> material = find_material(materials, recipe.material);
  if (!material) return fail(material);
  for (const auto& [key, value] : recipe.figures) {
    if (auto set = set_figure(material->material, key, value); !set) return fail(set);
  }
  Result<ObjectRecipe> whole = with_part_materials(recipe, materials);
  if (!whole) return fail(whole);
  if (recipe.other_material && !material->material.orthotropy) whole->options.makeup.grain.reset();
  const Makeup& makeup = whole->options.makeup;
  for (const char* key : {"youngs_modulus_pa", "poisson_ratio"}) {
    if (!makeup.grain || !makeup.parts.empty() || !recipe.figures.contains(key)) continue;
    return fail(ErrorKind::bad_input, std::string(key) +
                                          " has no effect on a body with a grain; set the constants along and across "
                                          "the grain, such as youngs_modulus_1_pa");
  }
  Result<BakedObject> object = bake_recipe(*whole, material->material, progress);
  if (!object) return object;
  object->baked.bank.gain = std::pow(10.0, recipe.gain_db / 20);
  object->baked.bank.pitch_hz = recipe.pitch_hz;
  return object;
}

}  // namespace ringdown::bake
