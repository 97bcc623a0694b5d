#include "engine/bake/recipe_options.h"

#include "engine/bake/makeup_file.h"

#include <vector>

namespace ringdown::bake {
namespace {

using Recipe = ObjectRecipe;
using Value = OptionValue;
using Options = BakeOptions;
using Meshing = mesh::GmshOptions;

constexpr Range kLength_m{1e-9, 1e6}, kAny{}, kAboveZero{0, kAnyHigh}, kError{1e-7, 0.5}, kShapeError{1e-3, 0.5};
constexpr Range kScale{1e-3, 1e3}, kWallScale{0.2, 5}, kAirDensity_kg_m3{1e-3, 20}, kSoundSpeed_m_s{10, 1e4};

// Sets the member that the path leads to from the recipe. A flag has an empty text.
template <auto... path>
Result<void> put(Recipe& recipe, const Value& value) {
  auto& member = (recipe.*....*path);
  using Member = std::remove_reference_t<decltype(member)>;
  if constexpr (std::is_same_v<Member, std::map<std::string, double>>) {
    member[value.text] = value.number;
  } else if constexpr (std::is_convertible_v<std::string, Member>) {
    member = value.text;
  } else {
    member = static_cast<Member>(value.number);
  }
  return {};
}

Result<void> set_element(Recipe& recipe, const Value& value) {
  return fem::parse_element(value.text).map([&](fem::Element element) {
    recipe.options.element = element;
    recipe.meshing.order = fem::order_of(element);
  });
}

Result<void> set_solver(Recipe& recipe, const Value& value) {
  return solve::parse_method(value.text).map([&](solve::Method method) { recipe.options.solver = method; });
}

Result<void> add_support(Recipe& recipe, const Value& value) {
  return parse_support(value.text).map([&](const Support& s) { recipe.options.makeup.supports.push_back(s); });
}

// A band of the command line is checked by bake().
Result<void> set_band(Recipe& recipe, const Value& value) {
  if (value.in_file && !(value.number >= 0 && value.second > value.number))
    return fail(ErrorKind::bad_input, "the band must go from a frequency >= 0 Hz to a higher one");
  recipe.options.band_low_hz = value.number;
  recipe.options.band_high_hz = value.second;
  return {};
}

Result<void> set_radiation(Recipe& recipe, const Value& value) {
  recipe.options.air = value.number == 0 ? std::nullopt : std::optional(recipe.options.air.value_or(modal::Air()));
  return {};
}

// On the command line --air implies --radiation. In a file it stands beside `radiation`, whose row comes before.
Result<void> set_air(Recipe& recipe, const Value& value) {
  if (!kAirDensity_kg_m3.holds(value.number) || !kSoundSpeed_m_s.holds(value.second))
    return fail(ErrorKind::bad_input,
                "--air takes a gas: a density of 0.001 to 20 kg/m3 and a speed of 10 to 10000 m/s; a liquid around the "
                "body is a [bath] of its object file");
  if (recipe.options.air || !value.in_file)
    recipe.options.air = modal::Air{.density_kg_m3 = value.number, .sound_speed_m_s = value.second};
  return {};
}

std::vector<RecipeOption> table() {
  using enum RecipeOption::Form;
  using enum RecipeOption::Trait;
  // Key, option, type and sentence; form, member, range in a file and on the command line, traits, demand.
  return {
      {"name", "--name", "TEXT", "name kept in the bank (default: the input's)", word, put<&Recipe::name>, kAny, kAny,
       kNotForScenes},
      {"element", "-e,--element", "tet20|tet10|tet35|tet4|tet4-lumped",
       "tet20 (default), tet10, tet35; tet4 and tet4-lumped are far too stiff in bending", word, set_element, kAny,
       kAny, 0, "element must be \"tet10\", \"tet20\", \"tet35\", \"tet4\" or \"tet4-lumped\""},
      {"mesh_size_m", "--mesh-size", "FLOAT",
       "longest edge in metres of the mesh of a surface or a geometry (default: from the band)", number,
       put<&Recipe::meshing, &Meshing::mesh_size_m>, kLength_m, kAboveZero},
      {"parameters", "--set", "NAME=NUMBER", "a parameter of a .geo file, in its unit", settings,
       put<&Recipe::meshing, &Meshing::parameters>, kAny, kAny, kOtherBody | kNotForScenes},
      {"unit_m", "--unit", "LENGTH", kUnitSentence, length, put<&Recipe::meshing, &Meshing::unit_m>, kLength_m, kAny,
       kOtherBody | kNotForScenes},
      {"cavities", "--cavities", "",
       "shells inside others are cavities, whatever their orientation (default: those of opposite orientation)", on,
       put<&Recipe::meshing, &Meshing::cavities>},
      {"force_coarse", "--force-coarse", "",
       "also bake bodies with walls too thin for the mesh; such walls get holes and sound wrong", on,
       put<&Recipe::meshing, &Meshing::force_coarse>},
      {"scale", "--scale", "FLOAT", "scale factor of the geometry; the mesh stays the same", number,
       put<&Recipe::scale>, kScale, kScale, kNotForScenes},
      {"", "--set-material", "NAME=NUMBER", "a figure of the material, e.g. poisson_ratio=0.31", settings,
       put<&Recipe::figures>, kAny, kAny, kOtherBody | kNotForScenes},
      {"", "--support", "TEXT",
       "a [[support]] in addition to those of the object file, in one line; lengths in metres before --scale", words,
       add_support, kAny, kAny, kOtherBody},
      {"shape_error", "--shape-error", "PERCENT",
       "amplitude error of the median mode for strikes between sample points (default 3%)", fraction,
       put<&Recipe::options, &Options::shape_error>, kShapeError},
      {"surface_points", "--points", "UINT",
       "number of sample points on the surface (default: as many as --shape-error needs)", count,
       put<&Recipe::options, &Options::points>, Range{4, 1e6}, Range{4, 1 << 20}},
      {"band_hz", "--band", "FLOAT", "LOW HIGH in Hz (default 20 20000)", pair, set_band, kAny, kAny, 0,
       "band_hz must be two frequencies in Hz, the lower first"},
      {"keep_modes", "--keep", "INT",
       "number of modes to keep, the most important ones and all those of --nonlinear (default: all in the band)",
       count, put<&Recipe::options, &Options::keep_modes>, Range{0, 1e6}, Range{1, 16384}},
      {"floor_db", "--floor", "FLOAT",
       "drop inaudible modes: after any blow this many dB below the loudest, or masked (default: none)", number,
       put<&Recipe::options, &Options::floor_db>, Range{1, 200}},
      {"nonlinear", "--nonlinear", "INT",
       "number of lowest modes that shift each other's pitch when struck hard; for thin bodies (default: none)", count,
       put<&Recipe::options, &Options::nonlinear>, Range{0, kMaxNonlinearModes}},
      {"coupled", "--coupled", "INT",
       "number of these modes, the lowest first, that exchange energy while they are loud: a gong's build-up; takes up "
       "to half a core for each object (default: none)",
       count, put<&Recipe::options, &Options::coupled>, Range{0, modal::kMaxCoupled}},
      {"radiation", "--radiation", "", "compute each mode's radiation and its damping by the air; takes minutes", on,
       set_radiation},
      {"air", "--air", "FLOAT",
       "the air around the body: DENSITY in kg/m3 and SPEED of sound in m/s (default 1.2041 343.2, dry air at 20 "
       "degrees); implies --radiation",
       pair, set_air, kAny, kAboveZero, 0,
       "air must be a gas: its density, 0.001 to 20 kg/m^3, and its speed of sound, 10 to 10000 m/s; a liquid around "
       "the body, whose mass moves along, is a [bath]"},
      {"error", "--error", "PERCENT",
       "refine until the estimated error of every frequency is below this: 0.1%, or 0.001", fraction,
       put<&Recipe::error>, kError},
      {"", "--preview", "", "coarse and quick: order 2; the error is stated", on, put<&Recipe::preview>, kAny, kAny,
       kNotWithLast},
      {"", "--no-cache", "",
       "neither use nor keep earlier results (in $RINGDOWN_CACHE, or ringdown in the user's cache folder)", on,
       put<&Recipe::options, &Options::cache>, kAny, kAny, kSameBank},
      {"", "--solver", "auto|block|spectra|dense|slepc",
       "auto (default), block, spectra, dense, or slepc: over MPI, for meshes too large for one machine", word,
       set_solver},
      {"", "--processes", "INT", "number of processes of --solver slepc (default 2)", count,
       put<&Recipe::options, &Options::processes>, kAny, Range{1, 4096}, kSameBank},
      {"verify", "--verify", "",
       "check the modes near two frequencies of the band with a second solver, and fail if the two disagree", on,
       put<&Recipe::options, &Options::verify>, kAny, kAny, kSameBank},
      {"wall_scale", "--wall-scale", "FLOAT",
       "scale factor of the walls' thickness: both sides move along the wall's normal, the size along the wall stays",
       number, put<&Recipe::meshing, &Meshing::wall_scale>, kWallScale, kWallScale, kOtherBody | kNotForScenes},
      {"gain_db", "", "", "", number, put<&Recipe::gain_db>, Range{-60, 60}},
      {"budget_s", "", "", "", number, put<&Recipe::budget_s>, Range{0.001, 1e6}},
  };
}

// The option's values in the file.
std::vector<OptionValue> values_in(TomlTable& file, const RecipeOption& option) {
  using enum RecipeOption::Form;
  OptionValue value{.text = "", .in_file = true};
  const auto [low, high] = option.in_file;
  bool is_on = false;
  std::uint64_t whole = 0;
  std::vector<double> numbers(2);
  std::map<std::string, double> named;
  if (option.form == word) file.text(option.key, value.text);
  if (option.form == number || option.form == length) file.number(option.key, value.number, option.in_file);
  if (option.form == fraction) file.fraction(option.key, value.number, option.in_file);
  if (option.form == on) {
    file.boolean(option.key, is_on);
    value.number = is_on ? 1 : 0;
  } else if (option.form == count) {
    file.whole(option.key, whole, static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(high));
    value.number = static_cast<double>(whole);
  } else if (option.form == pair) {
    file.numbers(option.key, numbers);
    if (numbers.size() != 2) file.complain(option.key, std::string(option.demand));
    numbers.resize(2);
    std::tie(value.number, value.second) = std::pair(numbers[0], numbers[1]);
  }
  if (option.form != settings) return {value};
  file.named_numbers(option.key, named);
  std::vector<OptionValue> values;
  for (const auto& [name, setting] : named) values.push_back({.text = name, .number = setting});
  return values;
}

}  // namespace

std::span<const RecipeOption> recipe_options() {
  static const std::vector<RecipeOption> options = table();
  return options;
}

void read_options(TomlTable& file, ObjectRecipe& recipe) {
  for (const RecipeOption& option : recipe_options()) {
    if (option.key.empty() || !file.has(option.key)) continue;
    for (const OptionValue& value : values_in(file, option)) {
      if (!option.set(recipe, value)) file.complain(option.key, std::string(option.demand));
    }
  }
}

}  // namespace ringdown::bake
